#include "reduced/surrogate/nnls.h"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

// Solves the normal equations of the columns in `passive`. A jitter of rounding size keeps nearly dependent columns
// solvable; where it does not, the slower factorisation does.
Eigen::VectorXd solve_passive(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                              const std::vector<Eigen::Index>& passive)
{
    const Eigen::Index count = Eigen::Index(passive.size());
    Eigen::MatrixXd g(count, count); // the lower half
    Eigen::VectorXd r(count);
    for (Eigen::Index j = 0; j < count; ++j) {
        r[j] = right[passive[std::size_t(j)]];
        for (Eigen::Index i = j; i < count; ++i) g(i, j) = gram(passive[std::size_t(i)], passive[std::size_t(j)]);
        g(j, j) *= 1 + 1e-10;
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(g);
    return factor.info() == Eigen::Success ? Eigen::VectorXd(factor.solve(r)) : Eigen::VectorXd(g.ldlt().solve(r));
}

// Towards the unconstrained solution of the passive set, dropping what would turn negative on the way. What is at zero goes
// at once, all together, and does not shorten the way of the others.
void descend(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right, std::vector<Eigen::Index>& passive,
             Eigen::VectorXd& x)
{
    while (!passive.empty()) {
        const Eigen::VectorXd target = solve_passive(gram, right, passive);
        double step = 1;
        for (std::size_t i = 0; i < passive.size(); ++i)
            if (target[Eigen::Index(i)] <= 0 && x[passive[i]] > 0)
                step = std::min(step, x[passive[i]] / (x[passive[i]] - target[Eigen::Index(i)]));
        const double rounding = 1e-14 * x.maxCoeff();
        std::vector<Eigen::Index> left;
        for (std::size_t i = 0; i < passive.size(); ++i) {
            double& value = x[passive[i]];
            value += step * (target[Eigen::Index(i)] - value);
            if (target[Eigen::Index(i)] > 0 || value > rounding)
                left.push_back(passive[i]);
            else
                value = 0;
        }
        const bool is_done = left.size() == passive.size();
        passive = std::move(left);
        if (is_done) break;
    }
}

} // namespace

Eigen::VectorXd nnls(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right, const Eigen::VectorXd& start)
{
    const Eigen::Index n = right.size();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Index> passive;
    if (start.size() == n) {
        x = start;
        passive.resize(std::size_t(n));
        std::iota(passive.begin(), passive.end(), Eigen::Index(0));
    }
    const double tolerance = 1e-10 * right.cwiseAbs().maxCoeff(); // gradients below this are rounding of the products above
    std::vector<char> is_barred(std::size_t(n), 0);               // was dropped as it came in: its gradient is rounding, too
    Eigen::Index best = -1;                                       // that came in last
    for (Eigen::Index round = 0; round < 3 * n; ++round) {
        descend(gram, right, passive, x);
        if (best >= 0 && x[best] <= 0) is_barred[std::size_t(best)] = 1;
        const Eigen::VectorXd descent = right - gram * x;
        best = -1;
        for (Eigen::Index i = 0; i < n; ++i)
            if (x[i] <= 0 && !is_barred[std::size_t(i)] && descent[i] > tolerance
                && (best < 0 || descent[i] > descent[best]))
                best = i;
        if (best < 0) break;
        passive.push_back(best);
    }
    return x;
}

namespace {

// Of the columns of `fit`, the leading ones of which `gram` has already.
void append_gram(const Eigen::MatrixXd& chosen, Eigen::MatrixXd& gram)
{
    const Eigen::Index before = gram.rows(), count = chosen.cols(), added = count - before;
    gram.conservativeResize(count, count);
    gram.rightCols(added) = chosen.transpose() * chosen.rightCols(added);
    gram.bottomLeftCorner(added, before) = gram.topRightCorner(before, added).transpose();
}

} // namespace

Eigen::VectorXd refit(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, SparseFit& fit, Eigen::MatrixXd& gram)
{
    const Eigen::Index count = Eigen::Index(fit.columns.size());
    Eigen::MatrixXd chosen(a.rows(), count);
    for (Eigen::Index i = 0; i < count; ++i) chosen.col(i) = a.col(Eigen::Index(fit.columns[std::size_t(i)])).cast<double>();
    append_gram(chosen, gram);
    Eigen::VectorXd start = Eigen::VectorXd::Zero(count);
    start.head(fit.weights.size()) = fit.weights;
    const Eigen::VectorXd x = nnls(gram, chosen.transpose() * b, start);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < count; ++i)
        if (x[i] > 0) kept.push_back(i);
    std::vector<std::size_t> columns;
    for (Eigen::Index i : kept) columns.push_back(fit.columns[std::size_t(i)]);
    fit.columns = std::move(columns);
    fit.weights = x(kept);
    gram = Eigen::MatrixXd(gram(kept, kept));
    return b - chosen * x;
}

SparseFit greedy_nnls(const Eigen::MatrixXf& a, const Eigen::VectorXd& b, std::size_t count, SparseFit start,
                      const std::function<void(std::size_t)>& keep_going)
{
    const Eigen::VectorXf norms = a.colwise().norm().cwiseMax(1e-30f);
    SparseFit fit = std::move(start);
    Eigen::MatrixXd gram;
    Eigen::VectorXd residual = fit.columns.empty() ? b : refit(a, b, fit, gram);
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
        const std::size_t before = fit.columns.size();
        std::size_t added = 0;
        for (; added < wanted; ++added) {
            if (is_chosen[order[added]] || gain[Eigen::Index(order[added])] <= 0) break;
            fit.columns.push_back(order[added]);
        }
        if (added == 0) break;
        const double last = residual.norm();
        residual = refit(a, b, fit, gram);
        const bool is_worthwhile = residual.norm() < (1 - least_gain) * last;
        if (!is_worthwhile && fit.columns.size() < before + added / 2) break;
    }
    fit.residual = residual.norm() / b.norm();
    return fit;
}

} // namespace pliant
