// The problem that the runtime solves each frame, in double precision: a surrogate energy energy in whitened coordinates,
// where to start, and what corrects it.
#pragma once

#include "base/weights/radial_function.h"
#include "reduced/surrogate/training.h"

#include <memory>
#include <optional>

namespace pliant {

// q = mean + whitening z. Minimized over z: surrogate(w, q) + load(w) . z, from predictor(w).
struct BlendModel {
    std::shared_ptr<const SurrogateEnergy> surrogate;
    Eigen::VectorXd mean;
    Eigen::MatrixXd whitening; // S: S S^T = inverse of the surrogate energy's Hessian, averaged over the training weights
    double energy_scale = 1;
    RadialFunction predictor;
    std::optional<RadialFunction> load;

    Eigen::VectorXd coordinates(const Eigen::VectorXd& z) const { return mean + whitening * z; }

    // The minimizer at w, in q.
    MinimizeResult solve(const Weights& w, double tolerance = 1e-6) const;
};

// Of blends next to reference averages, relative L2.
struct BlendError {
    double mean = 0, largest = 0;
    double usual_mean = 0, usual_largest = 0; // without outliers: what choices are made by
    // The largest avoidable_drift() of parts: the error of the body does not show a small part that is lost
    double drift = 0;
};

// The surrogate energy as it is: its own mean, its own minimizers as the predictor's data.
BlendModel plain_model(std::shared_ptr<const SurrogateEnergy> surrogate, const TrainingSet& training,
                       const Subspace& subspace);

// With a dead load: the linear term by which the training averages are exactly equilibria of the surrogate energy,
// interpolated in between. They are the predictor's data, too. Sound only where the surrogate energy is convex at them.
BlendModel loaded_model(std::shared_ptr<const SurrogateEnergy> surrogate, const TrainingSet& training,
                        const Subspace& subspace);

// `outlier_share` of the checks, rounded down, are outliers: those with the largest errors.
BlendError blend_error(const BlendModel& model, const Subspace& subspace, const NormalizedPoses& set,
                       const std::vector<CheckPoint>& checks, double outlier_share);

} // namespace pliant
