// The stage that finds the space of blends.
#pragma once

#include "bake/options.h"
#include "base/common/progress.h"
#include "elastic/average/interpolated_family.h"
#include "reduced/subspace/adaptive.h"

#include <memory>

namespace pliant {

// How near the averages of a bake must be: snapshots, checks, the mean.
NewtonOptions average_options(const BakeOptions& options, const NormalizedPoses& set);

// The basis, its snapshots (of an adaptive one), the unreduced averages at the check weights, and where others come from.
struct FoundFamily {
    FoundSubspace found;
    std::unique_ptr<AverageSource> source;
};

// The family must outlive the result. Cost: most of a bake; some thousand factorisations for five poses.
FoundFamily find_subspace(AverageFamily& family, const WeightDomain& domain, const BakeOptions& options,
                          const TimeBudget& budget, Progress& progress);

} // namespace pliant
