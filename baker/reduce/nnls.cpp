#include "reduce/nnls.h"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

// Solves the normal equations of the columns in `passive`. A jitter of rounding size keeps nearly dependent columns solvable.
Eigen::VectorXd solve_passive(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                              const std::vector<Eigen::Index>& passive)
{
    const Eigen::Index count = Eigen::Index(passive.size());
    Eigen::MatrixXd g(count, count);
    Eigen::VectorXd r(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        r[i] = right[passive[std::size_t(i)]];
        for (Eigen::Index j = 0; j < count; ++j) g(i, j) = gram(passive[std::size_t(i)], passive[std::size_t(j)]);
        g(i, i) *= 1 + 1e-10;
    }
    return g.ldlt().solve(r);
}

} // namespace

Eigen::VectorXd nnls(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right, const Eigen::VectorXd& start)
{
    const Eigen::Index n = right.size();
    Eigen::VectorXd x = start.size() == n ? start : Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Index> passive;
    for (Eigen::Index i = 0; i < n; ++i)
        if (x[i] > 0) passive.push_back(i);
    const double tolerance = 1e-10 * right.cwiseAbs().maxCoeff(); // gradients below this are rounding of the products above
    for (Eigen::Index round = 0; round < 3 * n; ++round) {
        // Inner loop: move towards the unconstrained solution of the passive set, dropping what would turn negative on the way.
        while (!passive.empty()) {
            const Eigen::VectorXd target = solve_passive(gram, right, passive);
            double step = 1;
            for (std::size_t i = 0; i < passive.size(); ++i)
                if (target[Eigen::Index(i)] <= 0)
                    step = std::min(step, x[passive[i]] / (x[passive[i]] - target[Eigen::Index(i)]));
            std::vector<Eigen::Index> left;
            for (std::size_t i = 0; i < passive.size(); ++i) {
                double& value = x[passive[i]];
                value += step * (target[Eigen::Index(i)] - value);
                if (step < 1 && value <= 1e-14 * x.maxCoeff()) value = 0;
                if (value > 0) left.push_back(passive[i]);
            }
            const bool is_done = step == 1;
            passive = std::move(left);
            if (is_done) break;
        }
        const Eigen::VectorXd descent = right - gram * x;
        Eigen::Index best = -1;
        for (Eigen::Index i = 0; i < n; ++i)
            if (x[i] <= 0 && descent[i] > tolerance && (best < 0 || descent[i] > descent[best])) best = i;
        if (best < 0) break;
        passive.push_back(best);
        x[best] = 1e-12 * std::max(1.0, x.maxCoeff()); // enters at practically zero
    }
    return x;
}

Eigen::VectorXd refit(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, SparseFit& fit)
{
    const Eigen::Index count = Eigen::Index(fit.columns.size());
    Eigen::MatrixXd chosen(a.rows(), count);
    for (Eigen::Index i = 0; i < count; ++i) chosen.col(i) = a.col(Eigen::Index(fit.columns[std::size_t(i)])).cast<double>();
    // New columns enter at practically zero.
    Eigen::VectorXd start
        = Eigen::VectorXd::Constant(count, 1e-12 * std::max(1.0, fit.weights.size() ? fit.weights.maxCoeff() : 1.0));
    start.head(fit.weights.size()) = fit.weights;
    const Eigen::VectorXd x = nnls(chosen.transpose() * chosen, chosen.transpose() * b, start);
    std::vector<std::size_t> kept;
    Eigen::VectorXd weights(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const std::size_t column = fit.columns[std::size_t(i)];
        if (x[i] <= 0) continue;
        weights[Eigen::Index(kept.size())] = x[i];
        kept.push_back(column);
    }
    fit.weights = weights.head(Eigen::Index(kept.size()));
    fit.columns = std::move(kept);
    return b - chosen * x.cwiseMax(0.0);
}

SparseFit greedy_nnls(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, std::size_t count, SparseFit start,
                      const std::function<void(std::size_t)>& keep_going)
{
    const Eigen::VectorXf norms = a.colwise().norm().cwiseMax(1e-30f);
    SparseFit fit = std::move(start);
    Eigen::VectorXd residual = fit.columns.empty() ? b : refit(a, b, fit);
    const std::size_t batch = std::max<std::size_t>(2, count / 16);
    // Refits can drop columns, so rounds are bounded, not counted on.
    for (int round = 0; round < 64 && fit.columns.size() < count; ++round) {
        keep_going(fit.columns.size());
        std::vector<char> is_chosen(std::size_t(a.cols()), 0);
        for (std::size_t column : fit.columns) is_chosen[column] = 1;
        const Eigen::VectorXf gain = (a.transpose() * residual.cast<float>()).cwiseQuotient(norms);
        std::vector<std::size_t> order(static_cast<std::size_t>(a.cols()));
        std::iota(order.begin(), order.end(), std::size_t(0));
        const std::size_t wanted = std::min(std::min(batch, count - fit.columns.size()), order.size());
        const auto is_better = [&](std::size_t i, std::size_t j) {
            const float gi = is_chosen[i] ? -1e30f : gain[Eigen::Index(i)],
                        gj = is_chosen[j] ? -1e30f : gain[Eigen::Index(j)];
            return gi != gj ? gi > gj : i < j;
        };
        std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(wanted), order.end(), is_better);
        std::size_t added = 0;
        for (; added < wanted; ++added) {
            if (is_chosen[order[added]] || gain[Eigen::Index(order[added])] <= 0) break;
            fit.columns.push_back(order[added]);
        }
        if (added == 0) break;
        residual = refit(a, b, fit);
    }
    fit.residual = residual.norm() / b.norm();
    return fit;
}

} // namespace pliant
