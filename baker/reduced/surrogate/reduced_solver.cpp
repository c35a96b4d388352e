#include "reduced/surrogate/reduced_solver.h"

#include <algorithm>
#include <utility>

namespace pliant {

ReducedSolver::ReducedSolver(const Energy& energy, const Subspace& subspace, const SparseLower& mean_hessian,
                             double energy_scale)
    : reduced_(energy, subspace)
    , energy_scale_(std::max(energy_scale, least_energy_scale))
{
    const Eigen::MatrixXd hessian = times_symmetric(subspace.basis.transpose(), mean_hessian) * subspace.basis;
    hessian_ = 0.5 * (hessian + hessian.transpose());
    measure_by(hessian_);
}

void ReducedSolver::measure_by(const Eigen::MatrixXd& hessian)
{
    whitening_ = whitening_of(hessian, metric_floor);
    metric_ = whitening_ * whitening_.transpose();
}

void ReducedSolver::hold(const NormalizedPoses& set)
{
    if (set.frame.size() == 0) return;
    const double curvature = hessian_.trace() / double(hessian_.rows());
    Gauge gauge = make_gauge(set, reduced_.energy().blend(), subspace(), energy_scale_, curvature);
    Eigen::MatrixXd hessian = hessian_;
    gauge.add_hessian(hessian);
    measure_by(hessian);
    reduced_.hold(std::move(gauge));
}

MinimizeResult ReducedSolver::solve(const Weights& w, const Eigen::VectorXd& start) const
{
    MinimizeOptions options;
    options.tolerance = 1e-4; // in the energy metric: leaves well below a tolerance of 1e-4 in shape
    options.scale = energy_scale_;
    return minimize([&](const Eigen::VectorXd& q, Eigen::VectorXd& gradient) { return reduced_.gradient(w, q, gradient); },
                    start, metric_, options);
}

ReducedStarts::ReducedStarts(const ReducedSolver& solver, const NormalizedPoses& set)
    : solver_(solver)
{
    for (std::size_t k = 0; k < set.pose_count(); ++k)
        add(corner_weights(set.pose_count(), k), solver.subspace().pose_coordinates.col(Eigen::Index(k)));
    fit();
}

void ReducedStarts::add(const Weights& w, const Eigen::VectorXd& q)
{
    for (const Weights& other : weights_)
        if ((other - w).norm() < closest_centres) return;
    weights_.push_back(w);
    coordinates_.push_back(q);
}

void ReducedStarts::fit()
{
    Eigen::MatrixXd values(solver_.subspace().dimension(), Eigen::Index(coordinates_.size()));
    for (std::size_t i = 0; i < coordinates_.size(); ++i) values.col(Eigen::Index(i)) = coordinates_[i];
    predictor_ = fit_radial_function(weights_, values);
}

Eigen::VectorXd ReducedStarts::operator()(const Weights& w) const
{
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < weights_.size(); ++i)
        if ((weights_[i] - w).norm() < (weights_[nearest] - w).norm()) nearest = i;
    const Subspace& subspace = solver_.subspace();
    const Energy& energy = solver_.energy().energy();
    // The linear change of weights, in coordinates, is a good first guess of the change of the average.
    const Eigen::VectorXd near = coordinates_[nearest] + subspace.pose_coordinates * (w - weights_[nearest]);
    const Eigen::VectorXd predicted = predictor_(w);
    return energy_value(energy, w, subspace.shape(predicted)) < energy_value(energy, w, subspace.shape(near)) ? predicted
                                                                                                              : near;
}

} // namespace pliant
