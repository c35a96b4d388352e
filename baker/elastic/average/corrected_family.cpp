#include "elastic/average/corrected_family.h"

#include "base/common/parallel.h"

#include <algorithm>
#include <atomic>
#include <fmt/core.h>

namespace pliant {

namespace {

// Shapes between two looks at the clock.
constexpr std::size_t timed_group_size = 4;

} // namespace

CorrectedFamily::CorrectedFamily(AverageFamily& family, Progress* progress)
    : family_(family)
    , mean_(family.mean().y)
    , sum_(family.sum())
    , progress_(progress)
    , learned_(corner_weights_of(family.pool().energy()))
{
    if (family.pool().energy().blend() == Blend::layers)
        learned_.push_back(family.centre());
    else
        learn({ { family.centre(), mean_, 0, 0, family.mean().has_converged, {} } });
}

Shape CorrectedFamily::guess(const Weights& w, std::size_t worker) const
{
    const Shape turned = sum_.turned(w, worker);
    if (corrections_.cols() == 0) return sum_.guess(w, turned, nullptr);
    const Shape correction = (corrections_ * shares_(w).cast<float>()).cast<double>();
    return sum_.guess(w, turned, &correction);
}

void CorrectedFamily::learn(const std::vector<CheckPoint>& points)
{
    const Eigen::Index before = corrections_.cols();
    corrections_.conservativeResize(family_.pool().set().dof_count(), before + Eigen::Index(points.size()));
    Eigen::Index count = before;
    for (const CheckPoint& point : points) {
        const bool is_known = std::any_of(learned_.begin(), learned_.end(),
                                          [&](const Weights& w) { return (w - point.weights).norm() < closest_centres; });
        if (!point.has_converged || is_known) continue;
        corrections_.col(count++) = (point.reference - sum_.turned(point.weights, 0)).cast<float>();
        learned_.push_back(point.weights);
    }
    corrections_.conservativeResize(Eigen::NoChange, count);
    if (learned_.empty()) return; // no average converged: guesses are sums
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(count, Eigen::Index(learned_.size()));
    values.rightCols(count).setIdentity();
    const bool has_layers = family_.pool().energy().blend() == Blend::layers;
    shares_ = fit_radial_function(learned_, values, has_layers);
}

std::vector<CheckPoint> CorrectedFamily::find(const std::vector<Weights>& weights, const Span& span, bool may_follow) const
{
    std::vector<CheckPoint> points(weights.size());
    SharedProgress shared(progress_);
    std::atomic<std::size_t> found { span.done };
    for_each_task(weights.size(), [&](std::size_t i, std::size_t worker) {
        if (worker == 0)
            shared.describe(span.stage, double(found) / double(span.total),
                            fmt::format("{} of {}", found.load(), span.total));
        FamilyPoint point = family_.from_guess(weights[i], guess(weights[i], worker), may_follow, worker, &shared);
        points[i] = { weights[i], std::move(point.average.y), 0, 0, point.average.has_converged, std::move(point.jumps) };
        ++found;
    });
    return points;
}

std::vector<CheckPoint> CorrectedFamily::find_in_time(const std::vector<Weights>& weights, const char* stage,
                                                      const TimeBudget& budget) const
{
    const std::size_t size = budget.has_limit() ? timed_group_size : weights.size();
    std::vector<CheckPoint> points;
    for (std::size_t done = 0; done < weights.size(); done = points.size()) {
        if (done > 0 && budget.is_spent()) break;
        const auto first = weights.begin() + std::ptrdiff_t(done),
                   last = weights.begin() + std::ptrdiff_t(std::min(weights.size(), done + size));
        for (CheckPoint& point : find({ first, last }, { stage, done, weights.size() }, true))
            points.push_back(std::move(point));
    }
    return points;
}

} // namespace pliant
