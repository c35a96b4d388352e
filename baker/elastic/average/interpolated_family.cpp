#include "elastic/average/interpolated_family.h"

#include "base/common/parallel.h"
#include "base/mesh/align.h"
#include "elastic/average/shape_error.h"

#include <algorithm>
#include <atomic>
#include <fmt/core.h>

namespace pliant {

namespace {

// A family that so many averages do not explain is not smooth: more of them would cost memory and say little.
constexpr std::size_t centre_limit = 64;

// Closer centres would make the interpolation follow their small errors.
constexpr double closest_centres_learned = 0.03;

} // namespace

InterpolatedFamily::InterpolatedFamily(AverageFamily& family, Progress* progress)
    : family_(family)
    , progress_(progress)
{
    const std::size_t m = set().pose_count();
    for (std::size_t k = 0; k < m; ++k) known_.push_back({ corner_weights(m, k), set().shapes[k], {} });
    known_.push_back({ equal_weights(m), family.mean().y, {} });
    SharedProgress shared(progress);
    shared.describe("averages", 0, "derivatives at the poses");
    for_each_task(known_.size(), [&](std::size_t i, std::size_t worker) {
        shared.update("", 0);
        known_[i].derivatives = derivatives(known_[i].weights, known_[i].shape, worker, false);
    });
    fit();
}

std::size_t InterpolatedFamily::learned_count() const { return known_.size() - set().pose_count() - 1; }

void InterpolatedFamily::fit()
{
    std::vector<Weights> centres;
    for (const Known& known : known_) centres.push_back(known.weights);
    interpolation_.emplace(centres);
}

Eigen::MatrixXd InterpolatedFamily::derivatives(const Weights& w, const Shape& y, std::size_t worker, bool has_factor) const
{
    NewtonSolver& solver = family_.pool().at(worker);
    if (!has_factor) solver.factorize_equilibrium(w, y);
    Eigen::MatrixXd out = solver.weight_derivatives(y, weight_directions(set().pose_count()));
    keep_aligned(set(), set().shapes[0], y, out);
    return out;
}

Shape InterpolatedFamily::at(const Weights& w) const
{
    const Eigen::MatrixXd shares = interpolation_->shares(w);
    Shape out = Shape::Zero(set().dof_count());
    for (std::size_t i = 0; i < known_.size(); ++i) {
        const auto share = shares.col(Eigen::Index(i));
        out += share[0] * known_[i].shape + known_[i].derivatives * share.tail(share.size() - 1);
    }
    return out;
}

KnownAverage InterpolatedFamily::nearest(const Weights& w) const
{
    const auto first = known_.begin() + std::ptrdiff_t(set().pose_count()); // a pose may lie on another branch
    const Known& known = *std::min_element(first, known_.end(), [&](const Known& a, const Known& b) {
        return (a.weights - w).lpNorm<1>() < (b.weights - w).lpNorm<1>();
    });
    return { known.weights, known.shape };
}

InterpolatedFamily::Found InterpolatedFamily::find_one(const Weights& w, std::size_t worker, Progress* progress) const
{
    Found found;
    const Shape guess = at(w);
    NewtonResult near = family_.near(guess, w, worker, progress, starts_exact_);
    const double corrected = relative_distance(set(), near.y, guess);
    found.started_definite = near.projected_iterations == 0;
    if (near.has_converged && corrected < correction_limit) {
        found.has_factor = near.ends_exact;
        found.point = { w, std::move(near.y), corrected, 0, true, {} };
        return found;
    }
    FamilyPoint point = family_.from(nearest(w), w, worker, progress);
    const double error = relative_distance(set(), point.average.y, guess);
    found.point = { w, std::move(point.average.y), error, 0, point.average.has_converged, std::move(point.jumps) };
    return found;
}

std::vector<InterpolatedFamily::Found> InterpolatedFamily::find_all(const std::vector<Weights>& weights, const Span& span,
                                                                    std::vector<Known>* learned) const
{
    std::vector<Found> all(weights.size());
    if (learned) learned->resize(weights.size());
    SharedProgress shared(progress_);
    std::atomic<std::size_t> done { span.done };
    for_each_task(weights.size(), [&](std::size_t i, std::size_t worker) {
        if (worker == 0)
            shared.describe(span.stage, double(done) / double(span.total), fmt::format("{} of {}", done.load(), span.total));
        all[i] = find_one(weights[i], worker, &shared);
        const Shape& y = all[i].point.reference;
        if (learned) (*learned)[i] = { weights[i], y, derivatives(weights[i], y, worker, all[i].has_factor) };
        ++done;
    });
    return all;
}

std::vector<CheckPoint> InterpolatedFamily::find(const std::vector<Weights>& weights, const Span& span) const
{
    std::vector<CheckPoint> points;
    for (Found& found : find_all(weights, span, nullptr)) points.push_back(std::move(found.point));
    return points;
}

std::vector<CheckPoint> InterpolatedFamily::learn(const std::vector<Weights>& weights, const Span& span)
{
    if (learned_count() >= centre_limit) return find(weights, span);
    std::vector<Known> learned;
    std::vector<CheckPoint> points;
    std::size_t definite_count = 0;
    for (Found& found : find_all(weights, span, &learned)) {
        definite_count += found.started_definite;
        points.push_back(std::move(found.point));
    }
    if (starts_exact_) starts_exact_ = 2 * definite_count >= weights.size();
    for (std::size_t i = 0; i < learned.size() && learned_count() < centre_limit; ++i) {
        const bool is_close = std::any_of(known_.begin(), known_.end(), [&](const Known& other) {
            return (other.weights - weights[i]).norm() < closest_centres_learned;
        });
        if (!is_close && points[i].has_converged) known_.push_back(std::move(learned[i]));
    }
    fit();
    return points;
}

} // namespace pliant
