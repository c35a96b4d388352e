// Ties every part of a character to its parent in the tree of parts.
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// Fills in tree, distances and ties of `out`, whose parts must be known, at least two. `columns`: the set in pose space (3m
// x n). Cost: n log n.
void attach_parts(const NormalizedPoses& set, const Eigen::MatrixXd& columns, TieSet& out);

} // namespace pliant
