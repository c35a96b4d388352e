// Interpolation over the weights, from values and first derivatives.
#pragma once

#include "base/weights/weights.h"

#include <Eigen/Dense>

namespace pliant {

// Changes of weights that keep their sum, as orthonormal columns (pose_count x (pose_count - 1)).
Eigen::MatrixXd weight_directions(std::size_t pose_count);

// Radial functions |w - w_i|^5, their derivatives and a quadratic polynomial, fitted to values and derivatives (Hermite-
// Birkhoff interpolation: Wendland, Scattered Data Approximation, 2005, chapter 16). Reproduces quadratic functions.
// Cost: the cube of centres times poses.
class HermiteInterpolation {
public:
    // Distinct centres, among them the corners of all poses.
    explicit HermiteInterpolation(const std::vector<Weights>& centres);

    // How much each datum counts at w. Column i belongs to centre i: the first row to the value there, row 1 + c to the
    // derivative along column c of weight_directions().
    Eigen::MatrixXd shares(const Weights& w) const;

private:
    Eigen::VectorXd functionals(const Weights& w) const;

    Eigen::MatrixXd directions_;
    Eigen::MatrixXd centres_; // columns, in coordinates along the directions
    Eigen::PartialPivLU<Eigen::MatrixXd> system_;
};

} // namespace pliant
