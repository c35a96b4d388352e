// The problem that the runtime solves each frame, in double precision: a stand-in energy in whitened coordinates, where to start, and
// what corrects it.
#pragma once

#include "base/weights/radial_function.h"
#include "reduced/surrogate/training.h"

#include <memory>
#include <optional>

namespace pliant {

// q = mean + root z. Minimised over z: stand_in(w, q) + load(w) . z, from predictor(w).
struct BlendModel {
    std::shared_ptr<const StandIn> stand_in;
    Eigen::VectorXd mean;
    Eigen::MatrixXd root; // S: S S^T = inverse of the stand-in's Hessian, averaged over the training weights
    double energy_scale = 1;
    Predictor predictor;
    std::optional<Predictor> load;

    Eigen::VectorXd coordinates(const Eigen::VectorXd& z) const { return mean + root * z; }

    // The minimiser at w, in q.
    MinimiseResult solve(const Weights& w, double tolerance = 1e-6) const;
};

// Of blends next to truths, relative L2.
struct BlendError {
    double mean = 0, largest = 0;
    double drift
        = 0; // the largest of tied vertices (elastic/parts/drift.h): a small part can be lost without that the body's error shows it
    double drift_of_truths = 0; // what no blend near them can be asked to stay below
};

// The stand-in as it is: its own mean, its own minimisers as the predictor's data.
BlendModel plain_model(std::shared_ptr<const StandIn> stand_in, const TrainingSet& training, const Subspace& subspace);

// With a dead load: the linear term by which the training averages are exactly equilibria of the stand-in, interpolated in between.
// They are the predictor's data, too. Sound only where the stand-in is convex at them.
BlendModel loaded_model(std::shared_ptr<const StandIn> stand_in, const TrainingSet& training, const Subspace& subspace);

BlendError blend_error(const BlendModel& model, const Subspace& subspace, const ShapeSet& set,
                       const std::vector<CheckPoint>& checks);

} // namespace pliant
