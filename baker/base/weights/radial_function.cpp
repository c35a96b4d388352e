#include "base/weights/radial_function.h"

#include <Eigen/Dense>
#include <cmath>

namespace pliant {

Eigen::VectorXd RadialFunction::operator()(const Weights& w) const
{
    Eigen::VectorXd features(coefficients.rows());
    for (std::size_t i = 0; i < centres.size(); ++i) features[Eigen::Index(i)] = std::pow((w - centres[i]).norm(), 3);
    features.tail(w.size()) = w;
    return coefficients.transpose() * features;
}

RadialFunction fit_radial_function(const std::vector<Weights>& centres, const Eigen::MatrixXd& values)
{
    const Eigen::Index n = Eigen::Index(centres.size()), m = centres[0].size();
    // Interpolation with the usual side conditions: the radial part is orthogonal to the linear functions.
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m, n + m);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j)
            system(i, j) = std::pow((centres[std::size_t(i)] - centres[std::size_t(j)]).norm(), 3);
        system.block(i, n, 1, m) = centres[std::size_t(i)].transpose();
        system.block(n, i, m, 1) = centres[std::size_t(i)];
    }
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n + m, values.rows());
    right.topRows(n) = values.transpose();
    RadialFunction predictor;
    predictor.centres = centres;
    predictor.coefficients = system.fullPivLu().solve(right);
    return predictor;
}

} // namespace pliant
