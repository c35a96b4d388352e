#include "reduced/subspace/adaptive.h"

#include "base/weights/sampling.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/energy/energy.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace pliant {

namespace {

// More snapshots for a dimension that was asked for come in groups of this.
constexpr std::size_t batch_size = 8;

// The shapes of a wave are explained if their interpolations were off by at most these multiples of the tolerance, and the
// whole wave if their energy was off by this part of itself on average. With more energy they are creased, and forces and
// stiffness there are wrong, which spoils the surrogate energy long before it shows in the shapes.
constexpr double mean_explained = 1, largest_explained = 4, excess_explained = 1e-4;

// Averages for each pose that are interpolated when the time for snapshots is spent.
constexpr std::size_t least_training = 8;

enum class Explained { nothing, shapes, all };

Explained explained_part(const InterpolatedFamily::Wave& wave, double tolerance)
{
    double mean = 0, largest = 0;
    for (const CheckPoint& point : wave.averages) {
        mean += point.error / double(wave.averages.size());
        largest = std::max(largest, point.error);
    }
    if (mean > mean_explained * tolerance || largest > largest_explained * tolerance) return Explained::nothing;
    return wave.energy_excess > excess_explained ? Explained::shapes : Explained::all;
}

// Averages that are enough to fit a surrogate energy to if only the shapes of others are explained.
std::size_t sound_count(std::size_t pose_count) { return pose_count * (pose_count + 2); }

// Averages at the training weights: unreduced ones in waves, each half as large as all before it, until one is explained.
void add_training(FoundSubspace& out, InterpolatedFamily& known, std::vector<Weights> training,
                  const AdaptiveOptions& options)
{
    const std::size_t pose_count = std::size_t(training[0].size()), smallest_wave = pose_count + 2;
    const TimeBudget& budget = options.snapshot_time;
    Explained explained = Explained::nothing;
    double seconds = 0; // of an average in the last wave
    const auto is_enough = [&](std::size_t count) {
        return explained == Explained::all || (explained == Explained::shapes && count >= sound_count(pose_count));
    };
    for (std::size_t done = 1; done < training.size() && !is_enough(done);) {
        const std::size_t end = std::min(training.size(), done + std::max(smallest_wave, done / 2));
        const double start = budget.elapsed();
        if (budget.is_spent(seconds * double(end - done))) {
            training.resize(std::min(training.size(), std::max(done, least_training * pose_count)));
            break;
        }
        InterpolatedFamily::Wave wave
            = known.learn({ &training[done], &training[0] + end }, { "averages", done, training.size(), true });
        explained = explained_part(wave, options.tolerance);
        seconds = (budget.elapsed() - start) / double(end - done);
        append_averages(out, std::move(wave.averages));
        done = end;
    }
    // If the time ended earlier, creased training data are better than almost none.
    out.has_sound_interpolations = explained != Explained::shapes || out.averages.size() < sound_count(pose_count);
    const std::vector<Weights> rest(training.begin() + std::ptrdiff_t(out.averages.size()), training.end());
    std::vector<Shape> shapes = known.at(rest);
    for (std::size_t i = 0; i < rest.size(); ++i) // without those that a solid cannot have
        if (std::isfinite(energy_value(known.family().pool().energy(), rest[i], shapes[i])))
            out.averages.push_back({ rest[i], std::move(shapes[i]), true });
}

} // namespace

std::size_t FoundSubspace::interpolated_count() const
{
    return std::size_t(
        std::count_if(averages.begin(), averages.end(), [](const KnownAverage& a) { return a.is_interpolated; }));
}

void append_averages(FoundSubspace& out, std::vector<CheckPoint> points)
{
    for (CheckPoint& point : points) {
        out.unconverged_count += !point.has_converged;
        out.averages.push_back({ point.weights, std::move(point.reference) });
    }
}

Subspace build_snapshot_subspace(const NormalizedPoses& set, const std::vector<KnownAverage>& averages,
                                 const AdaptiveOptions& options)
{
    Eigen::MatrixXd directions(set.dof_count(), Eigen::Index(averages.size()));
    for (std::size_t i = 0; i < averages.size(); ++i) directions.col(Eigen::Index(i)) = averages[i].shape - set.shapes[0];
    return build_subspace(set, directions, options.dimension ? options.dimension : options.max_dimension);
}

FoundSubspace build_adaptive_subspace(InterpolatedFamily& known, const std::vector<Weights>& training,
                                      const std::vector<Weights>& check_weights, const AdaptiveOptions& options,
                                      Progress* progress)
{
    const NormalizedPoses& set = known.family().pool().set();
    FoundSubspace out;
    out.averages.push_back({ training[0], known.mean() });
    add_training(out, known, training, options);
    Random random(options.seed);
    while (Eigen::Index(out.averages.size()) < options.dimension) {
        std::vector<Weights> batch;
        for (std::size_t i = 0; i < batch_size; ++i) batch.push_back(mixed_weights(random, set.pose_count(), i));
        append_averages(out, known.find(batch, { "averages", 0, batch.size() }));
    }
    out.checks = known.find_in_time(check_weights, "averages to check", options.check_time);
    if (progress) progress->update("subspace", 0.9, fmt::format("leading directions of {} snapshots", out.averages.size()));
    out.subspace = build_snapshot_subspace(set, out.averages, options);
    return out;
}

} // namespace pliant
