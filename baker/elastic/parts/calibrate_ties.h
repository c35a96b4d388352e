// How stiff the ties of each part must be, found by looking at averages.
#pragma once

#include "base/common/progress.h"
#include "elastic/average/sparse_cholesky.h"
#include "elastic/parts/tied_energy.h"

namespace pliant {

// Wanted of all parts of a character: farther from its place none may be, in units of the diagonal.
constexpr double drift_limit = 0.005;

// Looks at the averages of all poses and of any two of them. A part that has a joint (elastic/parts/joints.h) gets it or its ties, whatever keeps its
// place better; ties of parts that drift (elastic/parts/drift.h) are made stiffer, as far as that helps, or softer where that does; if some part still
// drifts farther than twice drift_limit then, all ties are as stiff as they were. Depends on nothing but energy and set, so that everyone who makes an energy of them means the same one. Costs one
// average for each of those weights and a few steps of Newton's method more for each round; nothing without ties.
void calibrate_ties(TiedEnergy& energy, const ShapeSet& set, SolverKind solver, Progress* progress);

} // namespace pliant
