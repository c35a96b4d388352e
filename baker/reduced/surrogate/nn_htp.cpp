#include "reduced/surrogate/nnls.h"

#include "base/common/random.h"

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

constexpr int pass_limit = 8;            // over all columns
constexpr std::size_t subset_factor = 5; // columns that compete in a round, per column wanted

// The `count` largest entries, those above zero only.
std::vector<std::size_t> largest(const Eigen::VectorXd& x, std::size_t count)
{
    std::vector<std::size_t> order(static_cast<std::size_t>(x.size()));
    std::iota(order.begin(), order.end(), std::size_t(0));
    count = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(count), order.end(), [&](std::size_t i, std::size_t j) {
        return x[Eigen::Index(i)] != x[Eigen::Index(j)] ? x[Eigen::Index(i)] > x[Eigen::Index(j)] : i < j;
    });
    while (count > 0 && x[Eigen::Index(order[count - 1])] <= 0) --count;
    order.resize(count);
    std::sort(order.begin(), order.end());
    return order;
}

// A gradient step within the columns of the fit and of `subset`, whose best length is that within `support`, and the largest
// of what comes out. Columns count as if they had unit norm.
std::vector<std::size_t> next_support(const Eigen::MatrixXf& a, const Eigen::VectorXd& norms, const SparseFit& fit,
                                      const Eigen::VectorXd& residual, const std::vector<std::size_t>& subset,
                                      std::size_t count)
{
    Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols()), gradient = x;
    const auto slope = [&](std::size_t column) {
        const Eigen::Index c = Eigen::Index(column);
        gradient[c] = double(a.col(c).dot(residual.cast<float>())) / norms[c];
    };
    for (std::size_t column : subset) slope(column);
    for (std::size_t i = 0; i < fit.columns.size(); ++i) {
        slope(fit.columns[i]);
        x[Eigen::Index(fit.columns[i])] = fit.weights[Eigen::Index(i)] * norms[Eigen::Index(fit.columns[i])];
    }
    const std::vector<std::size_t> support = fit.columns.empty() ? largest(gradient, count) : fit.columns;
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(a.rows());
    double square = 0;
    for (std::size_t column : support) {
        const double g = gradient[Eigen::Index(column)];
        moved += g / norms[Eigen::Index(column)] * a.col(Eigen::Index(column)).cast<double>();
        square += g * g;
    }
    const double length = moved.squaredNorm() > 0 ? square / moved.squaredNorm() : 0;
    return largest((x + length * gradient).cwiseMax(0.0), count);
}

} // namespace

SparseFit nn_htp(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, std::size_t count, SparseFit start,
                 const std::function<void(std::size_t)>& keep_going)
{
    const Eigen::VectorXd norms = a.colwise().norm().cwiseMax(1e-30f).cast<double>();
    const std::size_t size = std::size_t(a.cols()), subset_size = std::min(size, subset_factor * count);
    SparseFit best = std::move(start), fit = best;
    Eigen::MatrixXd gram;
    Eigen::VectorXd residual = fit.columns.empty() ? b : refit(a, b, fit, gram);
    best.residual = residual.norm() / b.norm();
    Random random(1);
    for (int pass = 0; pass < pass_limit; ++pass) {
        const double before = best.residual;
        // Neighbouring elements have nearly the same columns: among all of them the largest gradients belong to a few
        // places, among a random few to many.
        const std::vector<std::size_t> order = random.distinct(size, size);
        for (std::size_t first = 0; first < size; first += subset_size) {
            keep_going(fit.columns.size());
            const std::vector<std::size_t> subset(order.begin() + std::ptrdiff_t(first),
                                                  order.begin() + std::ptrdiff_t(std::min(size, first + subset_size)));
            const std::vector<std::size_t> support = next_support(a, norms, fit, residual, subset, count);
            if (support.empty()) continue;
            fit.columns = support;
            fit.weights.resize(0); // refitted from nothing: the columns are others
            gram.resize(0, 0);
            residual = refit(a, b, fit, gram);
            fit.residual = residual.norm() / b.norm();
            if (best.columns.empty() || fit.residual < best.residual) best = fit;
        }
        if (best.residual >= (1 - least_gain) * before) break;
    }
    return best;
}

} // namespace pliant
