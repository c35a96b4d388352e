// Preconditioned conjugate gradients (Hestenes, Stiefel 1952).
#pragma once

#include "elastic/average/hessian.h"

#include <functional>

namespace pliant {

struct ConjugateGradients {
    double accuracy;     // of the preconditioned residual over that of zero, squared
    int iteration_limit; // each takes a product with the matrix and a solve
};

struct ConjugateGradientsResult {
    Eigen::MatrixXd x;
    bool has_converged; // every column
};

// Solves matrix * x = loads, column by column but with common calls of `solve`, which applies the inverse of a matrix near
// to this one. The iteration starts from zero, so every iterate is a descent direction for its load. A column ends where a
// direction has no positive curvature.
ConjugateGradientsResult conjugate_gradients(const SparseLower& matrix, const Eigen::MatrixXd& loads,
                                             const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& solve,
                                             const ConjugateGradients& options);

} // namespace pliant
