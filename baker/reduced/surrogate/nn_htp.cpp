#include "reduced/surrogate/nnls.h"

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

constexpr int round_limit = 40;

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

// Length of the step along the gradient that is best within the columns of `support`, whose columns of A have unit norm.
double step_length(const Eigen::MatrixXf& unit, const Eigen::VectorXd& gradient, const std::vector<std::size_t>& support)
{
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(unit.rows());
    double square = 0;
    for (std::size_t column : support) {
        const double g = gradient[Eigen::Index(column)];
        moved += g * unit.col(Eigen::Index(column)).cast<double>();
        square += g * g;
    }
    return moved.squaredNorm() > 0 ? square / moved.squaredNorm() : 0;
}

} // namespace

SparseFit nn_htp(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, std::size_t count, SparseFit start,
                 const std::function<void(std::size_t)>& keep_going)
{
    const Eigen::VectorXd norms = a.colwise().norm().cwiseMax(1e-30f).cast<double>();
    Eigen::MatrixXf unit = a;
    for (Eigen::Index i = 0; i < a.cols(); ++i) unit.col(i) /= float(norms[i]);
    SparseFit best, fit = std::move(start);
    Eigen::MatrixXd gram;
    Eigen::VectorXd residual = fit.columns.empty() ? b : refit(a, b, fit, gram);
    for (int round = 0; round < round_limit; ++round) {
        keep_going(fit.columns.size());
        const Eigen::VectorXd gradient = (unit.transpose() * residual.cast<float>()).cast<double>();
        std::vector<std::size_t> support = fit.columns.empty() ? largest(gradient, count) : fit.columns;
        Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
        for (std::size_t i = 0; i < fit.columns.size(); ++i)
            x[Eigen::Index(fit.columns[i])] = fit.weights[Eigen::Index(i)] * norms[Eigen::Index(fit.columns[i])];
        x += step_length(unit, gradient, support) * gradient;
        fit.columns = largest(x.cwiseMax(0.0), count);
        fit.weights.resize(0); // refitted from nothing: the columns are others
        if (fit.columns.empty()) break;
        gram.resize(0, 0);
        residual = refit(a, b, fit, gram);
        fit.residual = residual.norm() / b.norm();
        const bool is_better = best.columns.empty() || fit.residual < (1 - least_gain) * best.residual;
        if (best.columns.empty() || fit.residual < best.residual) best = fit;
        if (!is_better) break;
    }
    return best;
}

} // namespace pliant
