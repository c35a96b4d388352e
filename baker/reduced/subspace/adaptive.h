// A subspace of snapshots: unreduced averages at training weights, and of them the leading directions (POD).
#pragma once

#include "elastic/average/family.h"
#include "reduced/subspace/subspace.h"

#include <cstdint>

namespace pliant {

struct AdaptiveOptions {
    // 0: as many as there are directions, at most max_dimension; else exactly this, if there are as many
    Eigen::Index dimension = 0;
    Eigen::Index max_dimension = 64;
    std::uint64_t seed = 1;
};

struct FoundSubspace {
    Subspace subspace;                  // leading directions first: fewer columns are the best smaller space
    std::vector<KnownAverage> averages; // full ones: the mean, those at the training weights, more for a dimension asked for
    std::vector<CheckPoint> checks;     // at `check_weights`; their errors are not set
    int unconverged_count = 0;          // averages that Newton left unconverged
};

// The family of averages a(w) is smooth in w, so that a basis of snapshots converges exponentially where the Krylov basis of
// Algorithm 1 stalls (reduced/THEORY.md, section 1). Averages at the training weights (the equal ones first, where `mean`
// is) are followed from each other; differences of the poses are kept exactly, and of the averages the leading directions.
// No snapshot is taken at the checks.
FoundSubspace build_adaptive_subspace(const AverageFamily& family, const KnownAverage& mean,
                                      const std::vector<Weights>& training, const std::vector<Weights>& check_weights,
                                      const AdaptiveOptions& options, Progress* progress);

} // namespace pliant
