// BFGS for the smooth, small problems of the baker (d unknowns, double precision).
#pragma once

#include <Eigen/Core>
#include <functional>

namespace pliant {

struct MinimizeOptions {
    // Converged when g^T B g <= tolerance^2 * scale, B the inverse Hessian: a distance in the energy metric, squared.
    double tolerance = 1e-6;
    double scale = 1;
    int max_iterations = 200;
};

struct MinimizeResult {
    Eigen::VectorXd q;
    double value = 0;
    int iterations = 0;
    bool has_converged = false;
};

// Returns the value and fills the gradient. May return +infinity.
using Objective = std::function<double(const Eigen::VectorXd& q, Eigen::VectorXd& gradient)>;

// Minimizes from `start` with `inverse_hessian` (d x d, positive definite) as the first metric.
MinimizeResult minimize(const Objective& objective, const Eigen::VectorXd& start, const Eigen::MatrixXd& inverse_hessian,
                        const MinimizeOptions& options);

// Inverse of a symmetric matrix made positive definite: eigenvalues below `floor` times the largest count as that. Returns S
// with S S^T = inverse, eigenvectors scaled, stiffest first.
Eigen::MatrixXd whitening_of(const Eigen::MatrixXd& hessian, double floor);

} // namespace pliant
