#include "reduce/training.h"

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

TrainingSet solve_training_set(const ReducedEnergy& reduced, std::vector<Weights> weights, Progress* progress)
{
    TrainingSet set;
    set.weights = std::move(weights);
    const Subspace& subspace = reduced.subspace();

    if (progress) progress->update("reduced averages", 0, "mean");
    // The mean from the pose of least energy, as the unreduced family has it.
    Eigen::Index best = 0;
    double best_energy = 0;
    for (Eigen::Index k = 0; k < subspace.pose_coordinates.cols(); ++k) {
        const double energy
            = energy_value(reduced.energy(), set.weights[0], subspace.shape(subspace.pose_coordinates.col(k)));
        if (k == 0 || energy < best_energy) best_energy = energy, best = k;
    }
    const MinimiseResult mean
        = minimise_newton(reduced, set.weights[0], Eigen::VectorXd(subspace.pose_coordinates.col(best)), 1e-6);
    if (!mean.has_converged && mean.iterations == 0)
        throw Failure(ExitCode::failed,
                      error_at(4401, "", "the reduced average of all poses does not converge",
                               "add an in-between pose, or try another --thickness"));
    set.root = inverse_root(reduced.hessian(set.weights[0], mean.q, HessianKind::exact), metric_floor);
    const Eigen::MatrixXd metric = set.root * set.root.transpose();
    set.averages.push_back(mean.q);
    set.energy_scale = mean.value;

    MinimiseOptions options;
    options.tolerance = 1e-4; // the stand-in is not better than that
    for (std::size_t t = 1; t < set.weights.size(); ++t) {
        if (progress)
            progress->update("reduced averages", double(t) / double(set.weights.size()),
                             fmt::format("{} of {}", t, set.weights.size()));
        const Weights& w = set.weights[t];
        std::size_t nearest = 0;
        for (std::size_t s = 1; s < t; ++s)
            if ((set.weights[s] - w).norm() < (set.weights[nearest] - w).norm()) nearest = s;
        // The linear change of weights, in coordinates, is a good first guess of the change of the average.
        const Eigen::VectorXd start = set.averages[nearest] + subspace.pose_coordinates * (w - set.weights[nearest]);
        options.scale = set.averages.size() ? set.energy_scale / double(set.averages.size()) : 1;
        const Objective objective
            = [&](const Eigen::VectorXd& q, Eigen::VectorXd& gradient) { return reduced.gradient(w, q, gradient); };
        MinimiseResult result = minimise(objective, start, metric, options);
        if (!result.has_converged) result = minimise_newton(reduced, w, result.q, 1e-6, 20);
        if (!result.has_converged) ++set.unconverged_count;
        set.averages.push_back(result.q);
        set.energy_scale += result.value;
    }
    set.energy_scale /= double(set.averages.size());
    return set;
}

} // namespace pliant
