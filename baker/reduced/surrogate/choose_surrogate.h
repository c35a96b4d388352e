// How many elements, and whether a dead load: decided by the error of blends, not by the residual of a fit. And how many
// dimensions.
#pragma once

#include "base/common/time_budget.h"
#include "reduced/surrogate/blend_model.h"
#include "reduced/surrogate/cubature.h"

#include <functional>

namespace pliant {

struct SurrogateOptions {
    double tolerance = 1e-3;       // wanted total error, mean over the checks
    double tolerance_max = 0;      // and the largest; 0: three times the tolerance is aimed at
    std::size_t element_count = 0; // 0: as few as keep the tolerance, four to twelve per dimension
    std::uint64_t seed = 1;
    CubatureSolver cubature = CubatureSolver::nnls;
    TimeBudget budget; // when it is spent, the best fit so far is taken
    double drift = 1;  // wanted of the parts of a character, over its limit

    double largest() const { return tolerance_max > 0 ? tolerance_max : 3 * tolerance; }
};

struct SurrogateReport {
    Curvature curvature;
    double residual = 0;   // of the cubature fit
    BlendError plain;      // over the checks, without the dead load
    BlendError loaded;     // with it; zeros if the surrogate energy is not convex
    bool has_load = false; // kept: it lowers the error

    const BlendError& error() const { return has_load ? loaded : plain; }
};

// A model and how good it is.
struct ChosenModel {
    BlendModel model;
    SurrogateReport report;
};

// Whether blends keep the tolerance at the checks with something in hand for other weights.
bool is_enough(const BlendError& error, const SurrogateOptions& options);

// Cubature of growing size until the blends at the checks keep the tolerance, or more elements do not help.
ChosenModel choose_cubature(const ReducedEnergy& reduced, const NormalizedPoses& set, const TrainingSet& training,
                            const std::vector<CheckPoint>& checks, const SurrogateOptions& options, Progress* progress);

// The model of a given surrogate energy; with a dead load if `may_load` and it helps. Without checks it is kept if the
// surrogate energy is convex.
ChosenModel fit_model(std::shared_ptr<const SurrogateEnergy> surrogate, const Subspace& subspace, const NormalizedPoses& set,
                      const TrainingSet& training, const std::vector<CheckPoint>& checks, bool may_load,
                      const SurrogateOptions& options);

// The smallest dimension from `least` to `most` with enough accuracy, or one that is larger by a sixteenth at most.
// `error_at` measures one, at most once; `predicted` is an error that falls with the dimension and to which the measured
// ones are about proportional. Where the tolerance is out of reach, the smallest that is about as good as the best of
// those that were measured: up to `most`, or to three that were no better than one with half the error predicted.
Eigen::Index choose_dimension(Eigen::Index least, Eigen::Index most, const SurrogateOptions& options,
                              const std::function<double(Eigen::Index)>& predicted,
                              const std::function<BlendError(Eigen::Index)>& error_at);

} // namespace pliant
