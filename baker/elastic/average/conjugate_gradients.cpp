#include "elastic/average/conjugate_gradients.h"

#include <algorithm>

namespace pliant {

ConjugateGradientsResult conjugate_gradients(const SparseLower& matrix, const Eigen::MatrixXd& loads,
                                             const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& solve,
                                             const ConjugateGradients& options)
{
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(loads.rows(), loads.cols()), residual = loads, z = solve(residual),
                    direction = z;
    Eigen::VectorXd size = residual.cwiseProduct(z).colwise().sum();
    const Eigen::VectorXd enough = options.accuracy * size;
    std::vector<bool> is_stuck(std::size_t(loads.cols()));
    const auto is_open = [&](Eigen::Index c) { return !is_stuck[std::size_t(c)] && size[c] > enough[c]; };
    for (int i = 0; i < options.iteration_limit; ++i) {
        bool is_done = true;
        for (Eigen::Index c = 0; c < x.cols(); ++c) {
            if (!is_open(c)) continue;
            const Eigen::VectorXd product = matrix.selfadjointView<Eigen::Lower>() * direction.col(c);
            const double curvature = direction.col(c).dot(product);
            is_stuck[std::size_t(c)] = !(curvature > 0);
            if (!(curvature > 0)) continue;
            is_done = false;
            x.col(c) += size[c] / curvature * direction.col(c);
            residual.col(c) -= size[c] / curvature * product;
        }
        if (is_done) break;
        z = solve(residual);
        for (Eigen::Index c = 0; c < x.cols(); ++c) {
            if (!is_open(c)) continue;
            const double next = residual.col(c).dot(z.col(c));
            direction.col(c) = z.col(c) + next / size[c] * direction.col(c);
            size[c] = next;
        }
    }
    bool has_converged = true;
    for (Eigen::Index c = 0; c < x.cols(); ++c) has_converged = has_converged && size[c] <= enough[c];
    return { std::move(x), has_converged };
}

} // namespace pliant
