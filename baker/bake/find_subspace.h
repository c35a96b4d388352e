// The stage that finds the space of blends.
#pragma once

#include "bake/options.h"
#include "base/common/progress.h"
#include "elastic/average/interpolated_family.h"
#include "reduced/subspace/adaptive.h"

namespace pliant {

// How near the averages of a bake must be: snapshots, checks, the mean.
NewtonOptions average_options(const BakeOptions& options, const NormalizedPoses& set);

// The basis, its snapshots (of an adaptive one) and the unreduced averages at the check weights.
// Cost: most of a bake; some thousand factorisations for five poses.
FoundSubspace find_subspace(InterpolatedFamily& known, SolverPool& pool, const BakeOptions& options,
                            const TimeBudget& budget, Progress& progress);

} // namespace pliant
