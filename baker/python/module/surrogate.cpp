#include "surrogate.h"

// The public functions of the runtime tell the energy at the end of a frame only.
extern "C" {
#include "internal.h"
}

namespace pliant {
namespace {

Eigen::MatrixXd whitening_of(const pliant_asset& asset)
{
    const Eigen::Index d = asset.dimension, stride = asset.padded_dimension;
    const Eigen::Map<const Eigen::MatrixXf> columns(asset.whitening, stride, d);
    return columns.topRows(d).cast<double>();
}

} // namespace

SurrogateCoordinates::SurrogateCoordinates(const pliant_asset& asset)
    : mean_(Eigen::Map<const Eigen::VectorXf>(asset.mean, asset.dimension).cast<double>())
    , whitening_(whitening_of(asset))
{
}

Eigen::VectorXd SurrogateCoordinates::to_z(const double* q) const
{
    return whitening_.solve(Eigen::Map<const Eigen::VectorXd>(q, mean_.size()) - mean_);
}

Eigen::VectorXd SurrogateCoordinates::gradient_by_q(const Eigen::VectorXd& gradient_by_z) const
{
    return whitening_.transpose().solve(gradient_by_z);
}

bool evaluate_surrogate(pliant_solver* solver, const Eigen::VectorXd& z, double& value, Eigen::VectorXd& gradient)
{
    // The solver's own scratch has the padding and the alignment that its kernels want; the padding stays zero.
    Eigen::Map<Eigen::VectorXf>(solver->trial, z.size()) = z.cast<float>();
    const bool is_finite = pliant_solver_evaluate(solver, solver->trial, &value, solver->trial_gradient) != 0;
    gradient = Eigen::Map<Eigen::VectorXf>(solver->trial_gradient, z.size()).cast<double>();
    return is_finite;
}

} // namespace pliant
