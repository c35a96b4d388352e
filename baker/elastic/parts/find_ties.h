// Finds the ties of a character from its poses: between its parts, their joints, and along its seams.
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// No ties for a solid, and for a surface in one part without seams. No joint is in use yet (elastic/parts/calibrate_ties.h
// decides). Cost: n log n.
TieSet find_ties(const NormalizedPoses& set);

} // namespace pliant
