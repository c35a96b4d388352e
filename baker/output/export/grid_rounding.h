// Numbers of a linear model rounded to whole ones together, so that its sums stay near and not each number for itself.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace pliant {

using Integers = Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic>;

// Weights w (columns) as (w, 1).
Eigen::MatrixXd with_one(const Eigen::MatrixXf& weights);

// Rounds x (rows x (d + 1)) of the model y(w) = x (w, 1) over sampled w. Column by column from the last, each takes over
// what the rounding of those after it moved y by, as well as its feature predicts theirs (nearest plane of Babai 1986).
// Where few parameters decide over all w, the error of y is less than that of one rounded column.
class GridRounding {
public:
    // Samples of w (d x samples).
    explicit GridRounding(const Eigen::MatrixXf& weights);

    // `last` holds the numbers that the last column rounds to, as a rule its own. Numbers above `limit` in size are cut to
    // it; columns before take over what they can. Cost: O(rows d^2).
    Integers round(const Eigen::MatrixXd& x, const Eigen::VectorXd& last, int limit) const;

private:
    Eigen::MatrixXd factor_; // upper triangular, factor^T factor = the Gram matrix of (w, 1)
};

} // namespace pliant
