// Ties the parts of a character to the parts that they hang on.
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// Fills in tree, distances and ties of a set whose parts are known, two or more. `columns`: pose space of the set.
void attach_parts(const ShapeSet& set, const Eigen::MatrixXd& columns, TieSet& out);

} // namespace pliant
