#include "output/export/grid_rounding.h"

#include <Eigen/Cholesky>

namespace pliant {

namespace {

// Added to the Gram matrix of numbers in [0,1]: how far (its root) a weight may stray from the samples. Without it columns
// that the samples do not tell apart would trade large amounts.
constexpr double stray = 1e-4;

// Samples count by the error that is to be expected of them, so that the largest error falls; more rounds gain little.
constexpr int weighing_rounds = 5;

} // namespace

Eigen::MatrixXd with_one(const Eigen::MatrixXf& weights)
{
    Eigen::MatrixXd features(weights.rows() + 1, weights.cols());
    features << weights.cast<double>(), Eigen::RowVectorXd::Ones(weights.cols());
    return features;
}

GridRounding::GridRounding(const Eigen::MatrixXf& weights)
{
    const Eigen::MatrixXd features = with_one(weights);
    Eigen::VectorXd counts = Eigen::VectorXd::Ones(weights.cols());
    for (int round = 0; round < weighing_rounds; ++round) {
        Eigen::MatrixXd gram = features * counts.asDiagonal() * features.transpose() / counts.sum();
        gram.diagonal().head(weights.rows()).array() += stray;
        factor_ = gram.llt().matrixU();
        // Rounding leaves numbers of one size in factor * left, times the diagonal of the factor.
        const Eigen::MatrixXd spread
            = factor_.diagonal().asDiagonal() * factor_.transpose().triangularView<Eigen::Lower>().solve(features);
        counts.array() *= spread.colwise().squaredNorm().transpose().array();
        counts /= counts.mean();
    }
}

Integers GridRounding::round(const Eigen::MatrixXd& x, const Eigen::VectorXd& last, int limit) const
{
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(x.rows(), x.cols()); // what rounding took away
    Integers rounded(x.rows(), x.cols());
    for (Eigen::Index i = x.cols(); i-- > 0;) {
        const Eigen::Index after = x.cols() - i - 1;
        Eigen::VectorXd wanted = after ? x.col(i) : last;
        if (after) wanted += left.rightCols(after) * factor_.row(i).tail(after).transpose() / factor_(i, i);
        const Eigen::VectorXd whole = wanted.array().round().max(-limit).min(limit);
        left.col(i) = x.col(i) - whole;
        rounded.col(i) = whole.cast<std::int16_t>();
    }
    return rounded;
}

} // namespace pliant
