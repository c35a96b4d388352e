#include "reduced/surrogate/blend_model.h"

#include "base/common/parallel.h"
#include "elastic/average/shape_error.h"
#include "elastic/parts/drift.h"
#include "elastic/parts/tied_energy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

namespace {

// Centres of the fits: the training weights, then the poses, where nothing needs correction. Pose 0 of layers is the first
// training weight.
std::vector<Weights> centres_of(const TrainingSet& training, const Energy& energy)
{
    std::vector<Weights> centres = training.weights;
    for (const Weights& corner : corner_weights_of(energy)) centres.push_back(corner);
    return centres;
}

RadialFunction fit_to_training(const TrainingSet& training, const Energy& energy, const Eigen::MatrixXd& values)
{
    return fit_radial_function(centres_of(training, energy), values, energy.blend() == Blend::layers);
}

// Weights and averages without those at which the surrogate energy is infinite: rough training data, as previews have them,
// may turn elements of a solid inside out. The first one, the mean, stays.
TrainingSet finite_part(const SurrogateEnergy& surrogate, const TrainingSet& training)
{
    TrainingSet out;
    out.energy_scale = training.energy_scale;
    for (std::size_t t = 0; t < training.weights.size(); ++t) {
        if (t > 0 && !std::isfinite(surrogate.value(training.weights[t], training.averages[t]))) continue;
        out.weights.push_back(training.weights[t]);
        out.averages.push_back(training.averages[t]);
    }
    return out;
}

double mean_energy(const SurrogateEnergy& surrogate, const TrainingSet& training)
{
    double energy = 0;
    for (std::size_t t = 0; t < training.weights.size(); ++t)
        energy += surrogate.value(training.weights[t], training.averages[t]);
    return std::max(energy / double(training.weights.size()), least_energy_scale);
}

// Mean of the Hessians at the averages: a metric for all weights (THEORY.md, section 6).
Eigen::MatrixXd mean_hessian(const SurrogateEnergy& surrogate, const TrainingSet& training)
{
    std::vector<Eigen::MatrixXd> hessians(training.weights.size());
    for_each_task(hessians.size(), [&](std::size_t t, std::size_t) {
        hessians[t] = surrogate.hessian(training.weights[t], training.averages[t], HessianKind::exact);
    });
    return std::accumulate(hessians.begin() + 1, hessians.end(), hessians[0]) / double(hessians.size());
}

BlendModel model_around(std::shared_ptr<const SurrogateEnergy> surrogate, const TrainingSet& training,
                        const Eigen::VectorXd& mean)
{
    BlendModel model;
    model.mean = mean;
    model.whitening = whitening_of(mean_hessian(*surrogate, training), metric_floor);
    const bool has_layers = surrogate->energy().blend() == Blend::layers;
    model.energy_scale = has_layers ? training.energy_scale : mean_energy(*surrogate, training);
    model.surrogate = std::move(surrogate);
    return model;
}

// Coordinates z of q.
Eigen::MatrixXd whitened(const BlendModel& model, const Eigen::MatrixXd& q)
{
    return Eigen::PartialPivLU<Eigen::MatrixXd>(model.whitening).solve(q.colwise() - model.mean);
}

// Room for the training averages, then the poses of corner_weights_of().
Eigen::MatrixXd pose_columns(const Subspace& subspace, std::size_t training_count, const Energy& energy)
{
    const Eigen::Index corners = Eigen::Index(weight_count(energy));
    Eigen::MatrixXd q(subspace.dimension(), Eigen::Index(training_count) + corners);
    q.rightCols(corners) = subspace.pose_coordinates.rightCols(corners);
    return q;
}

} // namespace

MinimizeResult BlendModel::solve(const Weights& w, double tolerance) const
{
    MinimizeOptions options;
    options.tolerance = tolerance;
    options.scale = energy_scale;
    const Eigen::VectorXd linear = load ? (*load)(w) : Eigen::VectorXd(Eigen::VectorXd::Zero(whitening.cols()));
    Eigen::VectorXd by_q;
    const Objective objective = [&](const Eigen::VectorXd& z, Eigen::VectorXd& gradient) {
        const double value = surrogate->gradient(w, coordinates(z), by_q);
        gradient = whitening.transpose() * by_q + linear;
        return value + linear.dot(z);
    };
    const Eigen::Index d = whitening.cols();
    MinimizeResult result = minimize(objective, predictor(w), Eigen::MatrixXd::Identity(d, d), options);
    result.q = coordinates(result.q);
    return result;
}

BlendModel plain_model(std::shared_ptr<const SurrogateEnergy> surrogate, const TrainingSet& given, const Subspace& subspace)
{
    const Energy& energy = surrogate->energy();
    const TrainingSet training = finite_part(*surrogate, given);
    const MinimizeResult mean = minimize_newton(*surrogate, training.weights[0], training.averages[0], 1e-8, 100);
    BlendModel model = model_around(std::move(surrogate), training, mean.q);
    const Eigen::MatrixXd metric = model.whitening * model.whitening.transpose();
    Eigen::MatrixXd q = pose_columns(subspace, training.weights.size(), energy);
    for_each_task(training.weights.size(), [&](std::size_t t, std::size_t) {
        MinimizeOptions options;
        options.scale = model.energy_scale;
        const Objective objective = [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
            return model.surrogate->gradient(training.weights[t], at, gradient);
        };
        q.col(Eigen::Index(t)) = minimize(objective, training.averages[t], metric, options).q;
    });
    model.predictor = fit_to_training(training, energy, whitened(model, q));
    return model;
}

BlendModel loaded_model(std::shared_ptr<const SurrogateEnergy> surrogate, const TrainingSet& given, const Subspace& subspace)
{
    const Energy& energy = surrogate->energy();
    const TrainingSet training = finite_part(*surrogate, given);
    BlendModel model = model_around(std::move(surrogate), training, training.averages[0]);
    Eigen::MatrixXd q = pose_columns(subspace, training.weights.size(), energy);
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(q.rows(), q.cols());
    for (std::size_t t = 0; t < training.weights.size(); ++t) {
        Eigen::VectorXd gradient;
        model.surrogate->gradient(training.weights[t], training.averages[t], gradient);
        loads.col(Eigen::Index(t)) = -model.whitening.transpose() * gradient;
        q.col(Eigen::Index(t)) = training.averages[t];
    }
    model.load = fit_to_training(training, energy, loads);
    model.predictor = fit_to_training(training, energy, whitened(model, q));
    return model;
}

BlendError blend_error(const BlendModel& model, const Subspace& subspace, const NormalizedPoses& set,
                       const std::vector<CheckPoint>& checks, double outlier_share)
{
    const Energy& energy = model.surrogate->energy();
    // a ghost's are of other vertices
    const TieSet* ties = energy.dof_count() == set.dof_count() ? ties_of(energy) : nullptr;
    std::vector<double> errors(checks.size()), drifts(checks.size(), 0);
    for_each_task(checks.size(), [&](std::size_t i, std::size_t) {
        const Shape shape = subspace.shape(model.solve(checks[i].weights).q);
        errors[i] = relative_error(set, shape, checks[i].reference);
        if (ties) drifts[i] = avoidable_drift(*ties, set, checks[i].weights, checks[i].reference, shape);
    });
    BlendError out;
    for (double drift : drifts) out.drift = std::max(out.drift, drift);
    std::sort(errors.begin(), errors.end());
    const std::size_t usual_count = errors.size() - std::size_t(outlier_share * double(errors.size()));
    for (std::size_t i = 0; i < errors.size(); ++i) {
        out.mean += errors[i] / double(errors.size());
        out.largest = errors[i];
        if (i >= usual_count) continue;
        out.usual_mean += errors[i] / double(usual_count);
        out.usual_largest = errors[i];
    }
    return out;
}

} // namespace pliant
