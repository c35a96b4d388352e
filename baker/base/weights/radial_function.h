// Smooth functions of the weights: where the runtime starts, a guess of the average, and its dead load (AssetModel::load).
#pragma once

#include "base/weights/weights.h"

namespace pliant {

// f(w) = sum_i |w - centre_i|^3 coefficients.row(i) + sum_k t_k coefficients.row(N + k): a cubic radial basis function with
// a linear tail. t is w, as on the simplex the w_k span constants and linear functions, or of layers (1, w). Interpolates
// its data.
struct RadialFunction {
    std::vector<Weights> centres;
    Eigen::MatrixXd coefficients; // (N + size of t) x d
    bool has_constant = false;    // t is (1, w)

    Eigen::VectorXd operator()(const Weights& w) const;
};

// Fits the values (columns of `values`, d x N) at distinct centres.
RadialFunction fit_radial_function(const std::vector<Weights>& centres, const Eigen::MatrixXd& values,
                                   bool has_constant = false);

// Interpolation needs distinct centres; closer ones (in weights) say the same.
constexpr double closest_centres = 1e-3;

} // namespace pliant
