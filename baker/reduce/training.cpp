#include "reduce/training.h"

#include "energy/parallel.h"
#include "report/diagnostics.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace pliant {

double Random::normal()
{
    // Box-Muller; 1 - u keeps the logarithm finite.
    return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(6.283185307179586 * uniform());
}

Weights Random::weights(std::size_t count, bool skew)
{
    Weights w(count);
    for (Eigen::Index k = 0; k < w.size(); ++k) w[k] = skew ? std::pow(uniform(), 3) : -std::log(1 - uniform());
    if (w.sum() < 1e-12)
        return equal_weights(count); // all numbers were zero: practically impossible, but it must not divide
    return w / w.sum();
}

Weights mixed_weights(Random& random, std::size_t pose_count, std::size_t index)
{
    if (pose_count == 2 || index % 3 == 0) return random.weights(pose_count, false);
    if (index % 3 == 2) return random.weights(pose_count, true);
    const std::size_t i = random.below(pose_count), j = (i + 1 + random.below(pose_count - 1)) % pose_count;
    const double t = 0.1 + 0.8 * random.uniform();
    return t * corner_weights(pose_count, i) + (1 - t) * corner_weights(pose_count, j);
}

std::vector<Weights> training_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed)
{
    std::vector<Weights> out = { equal_weights(pose_count) };
    if (pose_count == 2) {
        for (std::size_t i = 1; out.size() < count; ++i) {
            Weights w(2);
            w[0] = double(i) / double(count);
            w[1] = 1 - w[0];
            if (std::abs(w[0] - 0.5) > 1e-9) out.push_back(w);
            if (i + 1 == count) break;
        }
        return out;
    }
    Random random(seed);
    std::vector<Weights> edges;
    for (std::size_t i = 0; i < pose_count; ++i)
        for (std::size_t j = i + 1; j < pose_count; ++j)
            edges.push_back(0.5 * (corner_weights(pose_count, i) + corner_weights(pose_count, j)));
    const std::size_t edge_limit = std::min(edges.size(), count / 2);
    for (std::size_t i = 0; i < edge_limit; ++i) {
        std::swap(edges[i], edges[i + random.below(edges.size() - i)]);
        out.push_back(edges[i]);
    }
    while (out.size() < count) out.push_back(random.weights(pose_count, out.size() % 3 == 0));
    return out;
}

TrainingSet solve_training_set(const ReducedSolver& reduced, const ShapeSet& set, const std::vector<KnownAverage>& known,
                               std::vector<Weights> weights, Progress* progress)
{
    SharedProgress shared(progress);
    shared.describe("reduced averages", 0, "mean");
    TrainingSet training;
    training.weights = std::move(weights);
    training.root = reduced.root();
    ReducedStarts starts(reduced, set, known);
    const MinimiseResult mean = minimise_newton(reduced.energy(), training.weights[0], starts(training.weights[0]), 1e-6);
    if (!mean.has_converged && mean.iterations == 0)
        throw Failure(ExitCode::failed,
                      error_at(4401, "", "the reduced average of all poses does not converge",
                               "add an in-between pose, or try another --thickness"));
    training.averages.push_back(mean.q);
    training.energy_scale = mean.value;
    starts.add(training.weights[0], mean.q);
    starts.fit();

    // In waves, each as large as all before it: every solve starts from an interpolation of the earlier waves, and the result does not
    // depend on the number of threads.
    std::size_t done = 1;
    while (done < training.weights.size()) {
        const std::size_t end = std::min(training.weights.size(), done + std::max<std::size_t>(8, done + known.size()));
        shared.describe("reduced averages", double(done) / double(training.weights.size()),
                        fmt::format("{} of {}", done, training.weights.size()));
        std::vector<MinimiseResult> wave(end - done);
        for_each_task(wave.size(), [&](std::size_t i, std::size_t) {
            shared.update("", 0);
            const Weights& w = training.weights[done + i];
            wave[i] = reduced.solve(w, starts(w));
            if (!wave[i].has_converged) wave[i] = minimise_newton(reduced.energy(), w, wave[i].q, 1e-6, 20);
        });
        for (MinimiseResult& result : wave) {
            training.unconverged_count += !result.has_converged;
            training.energy_scale += result.value;
            starts.add(training.weights[training.averages.size()], result.q);
            training.averages.push_back(std::move(result.q));
        }
        starts.fit();
        done = end;
    }
    training.energy_scale = std::max(training.energy_scale / double(training.averages.size()), 1e-13);
    return training;
}

} // namespace pliant
