#include "elastic/average/interpolated_family.h"

#include "base/common/parallel.h"
#include "base/mesh/align.h"
#include "elastic/average/shape_error.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/core.h>
#include <numeric>

namespace pliant {

namespace {

// A family that so many averages do not explain is not smooth: more of them would cost memory and say little.
constexpr std::size_t centre_limit = 64;

// Rounding of an energy.
constexpr double least_energy = 1e-13;

// Creases with less of the energy of an average are not worth a look at every interpolated shape.
constexpr double least_crease_energy = 1e-5;

// Closer centres would make the interpolation follow their small errors.
constexpr double closest_centres_learned = 0.03;

// Where interpolated shapes have less energy above the averages than this share, most averages are found with the factor of
// a neighbour. Where they have more, steps with it mostly fail.
constexpr double smooth_excess = 1e-5;

// Averages of a chain are found one after the other. Longer chains save more factorisations and keep fewer threads busy.
constexpr std::size_t chain_length = 4;

// Averages between two looks at the clock: single ones, or two chains.
constexpr std::size_t group_size = 4, smooth_group_size = 2 * chain_length;

using Chain = std::vector<std::size_t>;

// Numbers of the weights from `begin` to `end`, each next to the one before it.
Chain by_neighbourhood(const std::vector<Weights>& weights, std::size_t begin, std::size_t end)
{
    Chain chain(end - begin);
    std::iota(chain.begin(), chain.end(), begin);
    for (std::size_t i = 1; i < chain.size(); ++i) {
        const auto distance = [&](std::size_t t) { return (weights[t] - weights[chain[i - 1]]).lpNorm<1>(); };
        const auto next = std::min_element(chain.begin() + std::ptrdiff_t(i), chain.end(),
                                           [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
        std::swap(chain[i], *next);
    }
    return chain;
}

// Two chains of each group.
std::vector<Chain> chains_of(const std::vector<Weights>& weights)
{
    std::vector<Chain> chains;
    for (std::size_t begin = 0; begin < weights.size(); begin += smooth_group_size) {
        const Chain group = by_neighbourhood(weights, begin, std::min(begin + smooth_group_size, weights.size()));
        const auto middle = group.begin() + std::ptrdiff_t((group.size() + 1) / 2);
        chains.emplace_back(group.begin(), middle);
        chains.emplace_back(middle, group.end());
    }
    return chains;
}

std::vector<Chain> single_ones(std::size_t count)
{
    std::vector<Chain> chains(count);
    for (std::size_t i = 0; i < count; ++i) chains[i] = { i };
    return chains;
}

} // namespace

InterpolatedFamily::InterpolatedFamily(AverageFamily& family, Progress* progress)
    : family_(family)
    , progress_(progress)
    , coordinates_(set(), family.mean().y)
    , fits_(worker_count())
{
    const std::size_t m = set().pose_count();
    for (std::size_t k = 0; k < m; ++k) known_.push_back({ corner_weights(m, k), set().shapes[k], {} });
    known_.push_back({ equal_weights(m), family.mean().y, {} });
    SharedProgress shared(progress);
    shared.describe("averages", 0, "derivatives at the poses");
    for_each_task(known_.size(), [&](std::size_t i, std::size_t worker) {
        shared.update("", 0);
        known_[i] = with_derivatives(known_[i].weights, known_[i].shape, worker, false);
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

InterpolatedFamily::Known InterpolatedFamily::with_derivatives(const Weights& w, const Shape& y, std::size_t worker,
                                                               bool has_near_factor) const
{
    NewtonSolver& solver = family_.pool().at(worker);
    const Eigen::MatrixXd directions = weight_directions(set().pose_count());
    Eigen::MatrixXd moves = solver.weight_derivatives(w, y, directions, has_near_factor);
    family_.placement().keep(w, directions, y, moves);
    const Eigen::VectorXd value = coordinates_.coordinates(y);
    Known known { w, y, Eigen::MatrixXf(value.size(), 1 + moves.cols()) };
    known.coordinates.col(0) = value.cast<float>();
    known.coordinates.rightCols(moves.cols()) = coordinates_.derivatives(y, value, moves).cast<float>();
    return known;
}

Shape InterpolatedFamily::unsettled(const Weights& w, std::size_t worker) const
{
    const Eigen::MatrixXf shares = interpolation_->shares(w).cast<float>();
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(known_[0].coordinates.rows());
    for (std::size_t i = 0; i < known_.size(); ++i)
        sum += (known_[i].coordinates * shares.col(Eigen::Index(i))).cast<double>();
    std::unique_ptr<CellFit>& fit = fits_[worker];
    if (!fit) fit = std::make_unique<CellFit>(set(), family_.pool().kind(), sliver_weight);
    return coordinates_.shape(sum, *fit);
}

Shape InterpolatedFamily::settled(const Weights& w, Shape shape, std::size_t worker) const
{
    return has_creases_ ? family_.pool().at(worker).settled(w, std::move(shape)) : shape;
}

std::vector<Shape> InterpolatedFamily::at(const std::vector<Weights>& weights) const
{
    std::vector<Shape> shapes(weights.size());
    SharedProgress shared(progress_);
    shared.describe("averages", 1, fmt::format("{} interpolated", weights.size()));
    for_each_task(weights.size(), [&](std::size_t i, std::size_t worker) {
        shared.update("", 0);
        shapes[i] = settled(weights[i], unsettled(weights[i], worker), worker);
        family_.placement().place(weights[i], shapes[i]); // settling moves them
    });
    return shapes;
}

KnownAverage InterpolatedFamily::nearest(const Weights& w) const
{
    const auto first = known_.begin() + std::ptrdiff_t(set().pose_count()); // a pose may lie on another branch
    const Known& known = *std::min_element(first, known_.end(), [&](const Known& a, const Known& b) {
        return (a.weights - w).lpNorm<1>() < (b.weights - w).lpNorm<1>();
    });
    return { known.weights, known.shape };
}

InterpolatedFamily::Found InterpolatedFamily::find_one(const Weights& w, bool has_near_factor, std::size_t worker,
                                                       Progress* progress) const
{
    Found found;
    Shape guess = unsettled(w, worker);
    const double unsettled_energy = energy_value(family_.pool().energy(), w, guess);
    guess = settled(w, std::move(guess), worker);
    NewtonResult near = family_.near(guess, w, worker, progress, has_near_factor);
    const double corrected = relative_distance(set(), near.y, guess), scale = std::max(near.energy, least_energy);
    found.has_factor = has_near_factor || near.iterations > 0;
    found.energy_excess = (near.start_energy - near.energy) / scale;
    found.crease_energy = (unsettled_energy - near.start_energy) / scale;
    if (near.has_converged && corrected < correction_limit) {
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
    const auto find = [&](std::size_t i, bool has_near_factor, std::size_t worker) {
        if (worker == 0) {
            const double share = double(done) / double(span.total);
            shared.describe(span.stage, span.may_end_early ? std::sqrt(share) : share,
                            fmt::format("{} of {}", done.load(), span.total));
        }
        all[i] = find_one(weights[i], has_near_factor, worker, &shared);
        const Shape& y = all[i].point.reference;
        if (learned) (*learned)[i] = with_derivatives(weights[i], y, worker, all[i].has_factor);
        ++done;
    };
    const std::vector<Chain> chains = is_smooth_ ? chains_of(weights) : single_ones(weights.size());
    for_each_task(chains.size(), [&](std::size_t chain, std::size_t worker) {
        for (std::size_t i : chains[chain]) find(i, i != chains[chain].front(), worker);
    });
    return all;
}

std::vector<CheckPoint> InterpolatedFamily::find(const std::vector<Weights>& weights, const Span& span) const
{
    std::vector<CheckPoint> points;
    for (Found& found : find_all(weights, span, nullptr)) points.push_back(std::move(found.point));
    return points;
}

std::vector<CheckPoint> InterpolatedFamily::find_in_time(const std::vector<Weights>& weights, const char* stage,
                                                         const TimeBudget& budget) const
{
    if (!budget.has_limit()) return find(weights, { stage, 0, weights.size() });
    std::vector<CheckPoint> points;
    do {
        const auto first = weights.begin() + std::ptrdiff_t(points.size());
        const std::size_t count = std::min(is_smooth_ ? smooth_group_size : group_size, weights.size() - points.size());
        for (CheckPoint& point : find({ first, first + std::ptrdiff_t(count) }, { stage, points.size(), weights.size() }))
            points.push_back(std::move(point));
    } while (points.size() < weights.size() && !budget.is_spent());
    return points;
}

InterpolatedFamily::Wave InterpolatedFamily::learn(const std::vector<Weights>& weights, const Span& span)
{
    std::vector<Known> learned;
    Wave wave;
    double crease_energy = 0;
    for (Found& found : find_all(weights, span, learned_count() < centre_limit ? &learned : nullptr)) {
        crease_energy += found.crease_energy / double(weights.size());
        wave.energy_excess += found.energy_excess / double(weights.size());
        wave.averages.push_back(std::move(found.point));
    }
    is_smooth_ = wave.energy_excess < smooth_excess;
    has_creases_ = has_creases_ && crease_energy > least_crease_energy;
    for (std::size_t i = 0; i < learned.size() && learned_count() < centre_limit; ++i) {
        const bool is_close = std::any_of(known_.begin(), known_.end(), [&](const Known& other) {
            return (other.weights - weights[i]).norm() < closest_centres_learned;
        });
        if (!is_close && wave.averages[i].has_converged) known_.push_back(std::move(learned[i]));
    }
    fit();
    return wave;
}

} // namespace pliant
