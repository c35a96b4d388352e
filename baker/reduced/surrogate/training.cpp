#include "reduced/surrogate/training.h"

#include "base/common/diagnostics.h"
#include "base/common/parallel.h"
#include "elastic/average/hessian.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <numeric>

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

namespace {

// Somewhere on the simplex, often on its edges and faces, where families of averages bend most.
Weights candidate_weights(Random& random, std::size_t pose_count, std::size_t index)
{
    const std::size_t members = index % 4 == 0 ? 2 : index % 4 == 1 ? 3 : pose_count;
    if (members >= pose_count) return random.weights(pose_count, index % 4 == 3);
    std::vector<std::size_t> poses(pose_count);
    std::iota(poses.begin(), poses.end(), std::size_t(0));
    const Weights part = random.weights(members, false);
    Weights w = Weights::Zero(Eigen::Index(pose_count));
    for (std::size_t i = 0; i < members; ++i) {
        std::swap(poses[i], poses[i + random.below(pose_count - i)]);
        w[Eigen::Index(poses[i])] = part[Eigen::Index(i)];
    }
    return w;
}

// Evenly spaced ones inside the edge, the middle first.
std::vector<Weights> edge_weights(std::size_t count)
{
    std::vector<Weights> out = { equal_weights(2) };
    const std::size_t parts = count | 1; // an odd number of parts never meets the middle
    for (std::size_t i = 1; out.size() < count; ++i)
        out.push_back(Weights(Eigen::Vector2d(double(i), double(parts - i)) / double(parts)));
    return out;
}

// Each the one of many candidates that is farthest from all before it and from the poses. Distances are those of the roots of the
// weights, on a sphere: they are longer near edges and corners.
std::vector<Weights> spread_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed)
{
    constexpr std::size_t candidates_each = 30;
    Random random(seed);
    std::vector<Weights> candidates = { equal_weights(pose_count) };
    while (candidates.size() < candidates_each * count)
        candidates.push_back(candidate_weights(random, pose_count, candidates.size()));
    std::vector<Eigen::VectorXd> roots;
    std::vector<double> nearest;
    for (const Weights& candidate : candidates) {
        roots.push_back(candidate.cwiseSqrt());
        nearest.push_back(2 - 2 * roots.back().maxCoeff()); // to the poses
    }
    std::vector<Weights> out;
    for (std::size_t chosen = 0; out.size() < count;) {
        out.push_back(candidates[chosen]);
        std::size_t farthest = 0;
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            nearest[i] = std::min(nearest[i], 2 - 2 * roots[chosen].dot(roots[i]));
            if (nearest[i] > nearest[farthest]) farthest = i;
        }
        chosen = farthest;
    }
    return out;
}

} // namespace

std::vector<Weights> training_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed)
{
    return pose_count == 2 ? edge_weights(count) : spread_weights(pose_count, count, seed);
}

std::vector<ProjectedAverage> project_averages(const Energy& energy, const Subspace& subspace, const ShapeSet& set,
                                               const std::vector<KnownAverage>& averages, Progress* progress)
{
    std::vector<Weights> taken;
    for (std::size_t k = 0; k < set.pose_count(); ++k) taken.push_back(corner_weights(set.pose_count(), k));
    std::vector<const KnownAverage*> kept;
    for (const KnownAverage& average : averages) {
        const bool is_near = std::any_of(taken.begin(), taken.end(), [&](const Weights& other) {
            return (other - average.weights).norm() < closest_centres;
        });
        if (is_near) continue;
        taken.push_back(average.weights);
        kept.push_back(&average);
    }
    SharedProgress shared(progress);
    shared.describe("training", 0, fmt::format("stiffness at {} averages", kept.size()));
    std::vector<ProjectedAverage> out(kept.size());
    for_each_task(kept.size(), [&](std::size_t i, std::size_t) {
        shared.update("", 0);
        const KnownAverage& average = *kept[i];
        HessianAssembler assembler(energy);
        assembler.assemble(average.weights, average.shape, HessianKind::exact);
        const Eigen::MatrixXd forces = assembler.matrix().selfadjointView<Eigen::Lower>() * subspace.basis;
        const Eigen::MatrixXd stiffness = subspace.basis.transpose() * forces;
        out[i] = { average.weights, &average.shape, project(subspace, average.shape, set.masses),
                   forces.transpose() * (average.shape - subspace.origin), 0.5 * (stiffness + stiffness.transpose()) };
    });
    return out;
}

TrainingSet training_of(const ReducedSolver& reduced, const std::vector<ProjectedAverage>& averages, double nearness)
{
    const Subspace& subspace = reduced.subspace();
    const Eigen::Index d = subspace.dimension();
    TrainingSet training;
    Eigen::MatrixXd mean_stiffness = Eigen::MatrixXd::Zero(d, d);
    for (const ProjectedAverage& average : averages) {
        Eigen::MatrixXd stiffness = average.stiffness.topLeftCorner(d, d);
        mean_stiffness += stiffness / double(averages.size());
        training.shapes.push_back(average.shape);
        training.stiffness.push_back(stiffness);
        stiffness.diagonal().array() += nearness;
        training.weights.push_back(average.weights);
        training.averages.push_back(stiffness.ldlt().solve(average.pull.head(d) + nearness * average.nearest.head(d)));
    }
    training.root = inverse_root(mean_stiffness, metric_floor);
    std::vector<double> energies(averages.size());
    for_each_task(energies.size(), [&](std::size_t t, std::size_t) {
        energies[t] = energy_value(reduced.energy().energy(), training.weights[t], subspace.shape(training.averages[t]));
    });
    training.energy_scale
        = std::max(std::accumulate(energies.begin(), energies.end(), 0.0) / double(energies.size()), 1e-13);
    return training;
}

TrainingSet solve_training_set(const ReducedSolver& reduced, const ShapeSet& set, std::vector<Weights> weights,
                               Progress* progress)
{
    SharedProgress shared(progress);
    shared.describe("reduced averages", 0, "mean");
    TrainingSet training;
    training.weights = std::move(weights);
    training.root = reduced.root();
    ReducedStarts starts(reduced, set);
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
        const std::size_t end = std::min(training.weights.size(), done + std::max<std::size_t>(8, done));
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
