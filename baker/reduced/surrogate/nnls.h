// Non-negative least squares for cubature: few columns out of many.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace pliant {

// min |A x - b|, x >= 0, given only the normal equations: gram = A^T A, right = A^T b (Lawson, Hanson 1974; the Gram form of
// Bro, de Jong 1997). `start` (may be empty) is a feasible first guess, and all columns are then tried as the first passive
// set.
Eigen::VectorXd nnls(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right, const Eigen::VectorXd& start = {});

// A batch of columns, or a round, that lowers the residual by less than this part is the last: the rest of it is in no
// column's reach.
constexpr double least_gain = 1e-3;

struct SparseFit {
    std::vector<std::size_t> columns;
    Eigen::VectorXd weights; // positive
    double residual = 0;     // |A x - b| / |b|
};

// Columns of A added greedily in batches by how much of the residual they explain (An, Kim, James 2008), all weights
// refitted by nnls after every batch, until `count` are positive. Goes on from `start` (may be empty). `keep_going` is asked
// between batches with the number found.
SparseFit greedy_nnls(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, std::size_t count, SparseFit start,
                      const std::function<void(std::size_t)>& keep_going);

// Non-negative hard thresholding pursuit (Foucart 2011; for cubature: von Tycowicz, Schulz, Seidel, Hildebrandt 2013): a
// gradient step within the columns of the fit and a random subset, the `count` largest weights are kept and refitted by
// nnls, and so on until all columns have had their turn without a gain. The method of the paper's cubature, compared with
// greedy_nnls in tests/paper. At most `count` columns, as few as nnls leaves positive.
SparseFit nn_htp(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, std::size_t count, SparseFit start,
                 const std::function<void(std::size_t)>& keep_going);

// Refits the weights of fit.columns by nnls (columns without weights yet enter at zero), drops those that become zero, and
// returns b - A x.
// `gram`: A^T A of as many leading columns as it is known of, empty at first; afterwards of all that are left.
Eigen::VectorXd refit(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, SparseFit& fit, Eigen::MatrixXd& gram);

} // namespace pliant
