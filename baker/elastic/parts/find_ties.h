// What ties a character of several parts together, found from its poses.
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// None for a surface in one part without such borders, and for solids. No joint is used yet. Costs n log n.
TieSet find_ties(const ShapeSet& set);

} // namespace pliant
