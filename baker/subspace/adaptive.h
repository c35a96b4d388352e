// A subspace of snapshots: true averages, chosen where the reduced blend is worst, until a wanted error is met.
#pragma once

#include "average/family.h"
#include "average/shape_error.h"
#include "subspace/subspace.h"

namespace pliant {

struct AdaptiveOptions {
    double tolerance = 1e-3;    // relative L2, mean over fresh check weights
    Eigen::Index dimension = 0; // 0: as few as meet the tolerance; else exactly this many (if there are as many directions)
    Eigen::Index max_dimension = 64;
    std::uint64_t seed = 1;
};

struct AdaptiveReport {
    int snapshot_count = 0;
    int check_count = 0;
    int unconverged_count = 0; // averages that Newton left unconverged
    double mean_error = 0;     // subspace alone, over the held-out checks, relative L2
    double largest_error = 0;
    Weights worst_weights; // where the largest was
    bool meets_tolerance = false;
};

// The family of averages a(w) is smooth in w, so that a basis of snapshots converges exponentially where the Krylov basis of Algorithm
// 1 stalls (notes in THEORY.md, section 3). Differences are kept exactly. The start is the average of all poses and those of pairs;
// then check weights are drawn, the reduced problem is solved there, and Newton's method on the full mesh goes on from that solution:
// the distance is the error of the reduced blend, the result the next snapshot. Cost: 6 factorisations a snapshot on
// the creature, 16 on bodies in very different poses (tests/bench/README.md).
Subspace build_adaptive_subspace(NewtonSolver& solver, const AdaptiveOptions& options, Progress* progress,
                                 AdaptiveReport& report);

} // namespace pliant
