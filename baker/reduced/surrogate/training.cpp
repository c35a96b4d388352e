#include "reduced/surrogate/training.h"

#include "base/common/diagnostics.h"
#include "base/common/parallel.h"
#include "elastic/average/hessian.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace pliant {

ProjectedAverage project_average(const Energy& energy, const Subspace& subspace, const NormalizedPoses& set,
                                 const Weights& w, const Shape& average)
{
    HessianAssembler assembler(energy);
    assembler.assemble(w, average, HessianKind::exact);
    const Eigen::MatrixXd forces = assembler.matrix().selfadjointView<Eigen::Lower>() * subspace.basis;
    const Eigen::MatrixXd stiffness = subspace.basis.transpose() * forces;
    return { w,
             &average,
             project(subspace, average, set.masses),
             forces.transpose() * (average - subspace.rest),
             0.5 * (stiffness + stiffness.transpose()),
             energy_value(energy, w, average) };
}

std::vector<ProjectedAverage> project_averages(const Energy& energy, const Subspace& subspace, const NormalizedPoses& set,
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
        out[i] = project_average(energy, subspace, set, kept[i]->weights, kept[i]->shape);
    });
    return out;
}

Eigen::VectorXd reduced_average(const ProjectedAverage& average, Eigen::Index d, double nearness)
{
    Eigen::MatrixXd stiffness = average.stiffness.topLeftCorner(d, d);
    stiffness.diagonal().array() += nearness;
    return stiffness.ldlt().solve(average.pull.head(d) + nearness * average.nearest.head(d));
}

TrainingSet training_of(const ReducedSolver& reduced, const std::vector<ProjectedAverage>& averages, double nearness)
{
    const Eigen::Index d = reduced.subspace().dimension();
    TrainingSet training;
    Eigen::MatrixXd mean_stiffness = Eigen::MatrixXd::Zero(d, d);
    double energy = 0;
    for (const ProjectedAverage& average : averages) {
        training.weights.push_back(average.weights);
        training.averages.push_back(reduced_average(average, d, nearness));
        training.shapes.push_back(average.shape);
        training.stiffness.push_back(average.stiffness.topLeftCorner(d, d));
        mean_stiffness += training.stiffness.back() / double(averages.size());
        energy += average.energy / double(averages.size());
    }
    training.whitening = whitening_of(mean_stiffness, metric_floor);
    training.energy_scale = std::max(energy, 1e-13);
    return training;
}

TrainingSet solve_training_set(const ReducedSolver& reduced, const NormalizedPoses& set, std::vector<Weights> weights,
                               Progress* progress)
{
    SharedProgress shared(progress);
    shared.describe("reduced averages", 0, "mean");
    TrainingSet training;
    training.weights = std::move(weights);
    training.whitening = reduced.whitening();
    ReducedStarts starts(reduced, set);
    const MinimizeResult mean = minimize_newton(reduced.energy(), training.weights[0], starts(training.weights[0]), 1e-6);
    if (!mean.has_converged && mean.iterations == 0)
        throw Failure(ExitCode::failed,
                      error_at(4401, "", "the reduced average of all poses does not converge",
                               "add an in-between pose, or try another --thickness"));
    training.averages.push_back(mean.q);
    training.energy_scale = mean.value;
    starts.add(training.weights[0], mean.q);
    starts.fit();

    // In waves, each as large as all before it: every solve starts from an interpolation of the earlier waves, and the
    // result does not depend on the number of threads.
    std::size_t done = 1;
    while (done < training.weights.size()) {
        const std::size_t end = std::min(training.weights.size(), done + std::max<std::size_t>(8, done));
        shared.describe("reduced averages", double(done) / double(training.weights.size()),
                        fmt::format("{} of {}", done, training.weights.size()));
        std::vector<MinimizeResult> wave(end - done);
        for_each_task(wave.size(), [&](std::size_t i, std::size_t) {
            shared.update("", 0);
            const Weights& w = training.weights[done + i];
            wave[i] = reduced.solve(w, starts(w));
            if (!wave[i].has_converged) wave[i] = minimize_newton(reduced.energy(), w, wave[i].q, 1e-6, 20);
        });
        for (MinimizeResult& result : wave) {
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
