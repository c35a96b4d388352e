// A subspace of snapshots: true averages, chosen where the reduced blend is worst, until a wanted error is met.
#pragma once

#include "average/family.h"
#include "subspace/subspace.h"

#include <cstdint>

namespace pliant {

struct AdaptiveOptions {
    double tolerance = 1e-3;  // wanted total error, relative L2, mean over the checks
    double tolerance_max = 0; // the largest over them; 0: three times the tolerance is aimed at, but not asked for
    Eigen::Index dimension
        = 0; // 0: as many as there are directions, at most max_dimension; else exactly this, if there are as many
    Eigen::Index max_dimension = 64;
    std::uint64_t seed = 1;
};

struct AdaptiveReport {
    int snapshot_count = 0;
    int unconverged_count = 0; // averages that Newton left unconverged
};

struct AdaptiveSubspace {
    Subspace subspace;                  // leading directions first: fewer columns are the best smaller space
    std::vector<KnownAverage> averages; // full ones: at `training` weights first, in their order, then others
    std::vector<CheckPoint> checks;     // at `check_weights`
};

// The family of averages a(w) is smooth in w, so that a basis of snapshots converges exponentially where the Krylov basis of Algorithm
// 1 stalls (THEORY.md, section 3). Differences are kept exactly. The start is what the family passed on its way to the average of all
// poses, and the tangents there. Then the training weights (the equal ones first) are gone through: the reduced problem is solved
// there, and Newton's method on the full mesh goes on from that solution: the distance is the error of the reduced blend, the result
// the next snapshot. In the end the leading directions of all snapshots are kept. No snapshot is taken at the checks that are left.
AdaptiveSubspace build_adaptive_subspace(AverageFamily& family, SolverPool& pool, const std::vector<Weights>& training,
                                         const std::vector<Weights>& check_weights, const AdaptiveOptions& options,
                                         Progress* progress, AdaptiveReport& report);

// The checks for any other subspace.
std::vector<CheckPoint> solve_checks(AverageFamily& family, SolverPool& pool, const Subspace& subspace,
                                     const std::vector<Weights>& check_weights, Progress* progress);

} // namespace pliant
