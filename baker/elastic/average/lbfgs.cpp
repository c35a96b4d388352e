#include "elastic/average/lbfgs.h"

namespace pliant {

namespace {

constexpr std::size_t pair_limit = 8;

constexpr double least_curvature = 1e-12; // over the norms of the pair: below it is rounding

} // namespace

void LimitedMemoryBfgs::add(const Shape& step, const Shape& change)
{
    const double curvature = step.dot(change);
    if (!(curvature > least_curvature * step.norm() * change.norm())) return;
    if (pairs_.size() == pair_limit) pairs_.pop_front();
    pairs_.push_back({ step, change, curvature });
}

// The two loops of Nocedal and Wright 2006, algorithm 7.4.
Shape LimitedMemoryBfgs::direction(const Shape& gradient, const std::function<Shape(const Shape&)>& solve) const
{
    Shape q = gradient;
    std::vector<double> alphas;
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
        alphas.push_back(pair->step.dot(q) / pair->curvature);
        q -= alphas.back() * pair->change;
    }
    Shape r = solve(q);
    for (const Pair& pair : pairs_) {
        r += (alphas.back() - pair.change.dot(r) / pair.curvature) * pair.step;
        alphas.pop_back();
    }
    return -r;
}

} // namespace pliant
