#include "base/weights/radial_function.h"

#include <Eigen/Dense>
#include <cmath>

namespace pliant {

Eigen::VectorXd RadialFunction::operator()(const Weights& w) const
{
    Eigen::VectorXd features(coefficients.rows());
    for (std::size_t i = 0; i < centres.size(); ++i) features[Eigen::Index(i)] = std::pow((w - centres[i]).norm(), 3);
    features.tail(w.size()) = w;
    if (has_constant) features[Eigen::Index(centres.size())] = 1;
    return coefficients.transpose() * features;
}

RadialFunction fit_radial_function(const std::vector<Weights>& centres, const Eigen::MatrixXd& values, bool has_constant)
{
    const Eigen::Index n = Eigen::Index(centres.size()), m = centres[0].size() + has_constant;
    // Interpolation with the usual side conditions: the radial part is orthogonal to the linear functions.
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m, n + m);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j)
            system(i, j) = std::pow((centres[std::size_t(i)] - centres[std::size_t(j)]).norm(), 3);
        system.row(i).tail(centres[0].size()) = centres[std::size_t(i)].transpose();
        if (has_constant) system(i, n) = 1;
        system.block(n, i, m, 1) = system.block(i, n, 1, m).transpose();
    }
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n + m, values.rows());
    right.topRows(n) = values.transpose();
    RadialFunction predictor;
    predictor.centres = centres;
    predictor.has_constant = has_constant;
    predictor.coefficients = system.fullPivLu().solve(right);
    return predictor;
}

} // namespace pliant
