#include "reduced/surrogate/minimize.h"

#include <Eigen/Dense>
#include <cmath>

namespace pliant {

MinimizeResult minimize(const Objective& objective, const Eigen::VectorXd& start, const Eigen::MatrixXd& inverse_hessian,
                        const MinimizeOptions& options)
{
    MinimizeResult result;
    result.q = start;
    Eigen::VectorXd gradient(start.size()), next_gradient(start.size());
    result.value = objective(start, gradient);
    Eigen::MatrixXd metric = inverse_hessian;
    bool is_fresh = true;
    for (; result.iterations < options.max_iterations; ++result.iterations) {
        Eigen::VectorXd step = -metric * gradient;
        double slope = gradient.dot(step);
        if (-slope <= options.tolerance * options.tolerance * options.scale) {
            result.has_converged = true;
            return result;
        }
        if (!(slope < 0)) return result;
        // Differences of values below rounding mean nothing: there the slope decides.
        const bool is_noise = -slope < 1e-11 * std::abs(result.value);
        double length = 1, value = 0;
        for (;;) {
            value = objective(result.q + length * step, next_gradient);
            if (value <= result.value + 1e-4 * length * slope) break;
            if (is_noise && std::abs(next_gradient.dot(step)) <= 0.9 * -slope) break;
            length *= 0.4;
            if (length < 1e-9) {
                if (is_fresh) return result;
                metric = inverse_hessian; // the collected curvature misleads: forget it once
                is_fresh = true;
                break;
            }
        }
        if (length < 1e-9) continue;
        const Eigen::VectorXd s = length * step, y = next_gradient - gradient;
        result.q += s;
        result.value = value;
        gradient = next_gradient;
        is_fresh = false;
        const double sy = s.dot(y);
        if (sy > 1e-12 * s.norm() * y.norm()) { // curvature condition with room for rounding
            const Eigen::VectorXd by = metric * y;
            const double factor = (1 + y.dot(by) / sy) / sy;
            metric += factor * s * s.transpose() - (by * s.transpose() + s * by.transpose()) / sy;
        }
    }
    return result;
}

Eigen::MatrixXd whitening_of(const Eigen::MatrixXd& hessian, double floor)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
    const Eigen::VectorXd values = eigen.eigenvalues();
    const double largest = values[values.size() - 1];
    return (eigen.eigenvectors() * values.cwiseMax(floor * largest).cwiseSqrt().cwiseInverse().asDiagonal())
        .rowwise()
        .reverse();
}

} // namespace pliant
