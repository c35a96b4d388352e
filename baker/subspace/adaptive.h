// A subspace of snapshots: true averages, chosen where the reduced blend is worst, until a wanted error is met.
#pragma once

#include "average/family.h"
#include "subspace/subspace.h"

#include <cstdint>

namespace pliant {

struct AdaptiveOptions {
    double tolerance = 1e-3;    // relative L2 of the subspace, mean over the checks
    double tolerance_max = 0;   // the largest over them; 0: three times the tolerance is aimed at, but not asked for
    Eigen::Index dimension = 0; // 0: as few as meet the tolerance; else exactly this many (if there are as many directions)
    Eigen::Index max_dimension = 64;
    std::uint64_t seed = 1;
};

struct AdaptiveReport {
    int snapshot_count = 0;
    int probe_count = 0;       // weights at which a blend was compared with the average to find snapshots
    int unconverged_count = 0; // averages that Newton left unconverged
};

struct AdaptiveSubspace {
    Subspace subspace;
    std::vector<KnownAverage> snapshots; // without the poses
    std::vector<CheckPoint> checks;      // at `check_weights`
};

// The family of averages a(w) is smooth in w, so that a basis of snapshots converges exponentially where the Krylov basis of Algorithm
// 1 stalls (THEORY.md, section 3). Differences are kept exactly. The start is what the family passed on its way to the average of all
// poses, the tangents there, and the averages of pairs; then weights are drawn, the reduced problem is solved there, and Newton's
// method on the full mesh goes on from that solution: the distance is the error of the reduced blend, the result the next snapshot.
// In the end the leading directions of all snapshots are kept, as many as the checks ask for: weights at which no snapshot is taken.
AdaptiveSubspace build_adaptive_subspace(AverageFamily& family, SolverPool& pool, const std::vector<Weights>& check_weights,
                                         const AdaptiveOptions& options, Progress* progress, AdaptiveReport& report);

// The checks for any other subspace.
std::vector<CheckPoint> solve_checks(AverageFamily& family, SolverPool& pool, const Subspace& subspace,
                                     const std::vector<Weights>& check_weights, Progress* progress);

} // namespace pliant
