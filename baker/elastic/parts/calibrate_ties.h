// Chooses the stiffness of ties, and joints instead of ties, by computing averages and measuring drift (drift.h).
#pragma once

#include "base/common/progress.h"
#include "elastic/average/sparse_cholesky.h"
#include "elastic/parts/tied_energy.h"

namespace pliant {

struct CoarseBody;

// Computes the average of all poses and of every pair, and repeats with changed ties while that helps. A part with a joint
// gets the joint or its ties, whichever drifts less. The ties of parts that drift are balanced, made stiffer, or made
// softer. If some part still drifts by more than twice drift_limit, all ties keep their first stiffness.
// `coarse`: null, or where the mean is searched, with ties of its own.
// Depends on the inner energy, the ties and the set only, so that every user of the same poses gets the same energy.
// Cost: one average for each of those weights, then a few Newton steps for each weight and round.
void calibrate_ties(TiedEnergy& energy, const NormalizedPoses& set, SolverKind solver, const CoarseBody* coarse,
                    Progress* progress);

} // namespace pliant
