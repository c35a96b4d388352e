// A subspace of snapshots: unreduced averages at training weights, and of them the leading directions (POD).
#pragma once

#include "base/common/time_budget.h"
#include "elastic/average/interpolated_family.h"
#include "reduced/subspace/subspace.h"

#include <cstdint>

namespace pliant {

struct AdaptiveOptions {
    // 0: as many as there are directions, at most max_dimension; else exactly this, if there are as many
    Eigen::Index dimension = 0;
    Eigen::Index max_dimension = 64;
    // Averages that the interpolation of the others gives to a part of this (relative L2) are not computed.
    double tolerance = 1e-3;
    std::uint64_t seed = 1;
    TimeBudget snapshot_time, check_time; // no wave starts that would end later; as find_in_time()
};

struct FoundSubspace {
    Subspace subspace;                  // leading directions first: fewer columns are the best smaller space
    std::vector<KnownAverage> averages; // the mean, those at the training weights, more for a dimension asked for
    std::vector<CheckPoint> checks;     // unreduced averages at `check_weights`, or the first of them
    // The energies of interpolated averages are right as well as their shapes: a surrogate energy can be fitted to them.
    bool has_sound_interpolations = true;
    int unconverged_count = 0; // averages that Newton left unconverged

    std::size_t interpolated_count() const; // of the averages; the others are unreduced averages
};

// Adds averages that were found.
void append_averages(FoundSubspace& out, std::vector<CheckPoint> points);

// Differences of the poses, exactly, and of the averages the leading directions.
Subspace build_snapshot_subspace(const NormalizedPoses& set, const std::vector<KnownAverage>& averages,
                                 const AdaptiveOptions& options);

// The family of averages a(w) is smooth in w, so that a basis of snapshots converges exponentially where the Krylov basis of
// Algorithm 1 stalls (reduced/THEORY.md, section 1). Averages at the training weights (the equal ones first, where the mean
// is) are learned in waves until the interpolation of those before says what a wave finds; the rest is interpolated. Where
// it says the shapes but not their energies, m (m + 2) averages of m poses are learned.
// Differences of the poses are kept exactly, and of the averages the leading directions. No snapshot is taken at the checks.
FoundSubspace build_adaptive_subspace(InterpolatedFamily& known, const std::vector<Weights>& training,
                                      const std::vector<Weights>& check_weights, const AdaptiveOptions& options,
                                      Progress* progress);

} // namespace pliant
