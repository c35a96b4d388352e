#include "reduced/surrogate/training.h"

#include "base/common/diagnostics.h"
#include "base/common/parallel.h"
#include "elastic/average/hessian.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <memory>

namespace pliant {

namespace {

// Inverse squares of the distances between weights count (Shepard 1968). A mean of positive definite matrices is positive
// definite.
Eigen::MatrixXd interpolated_stiffness(const std::vector<ProjectedAverage>& around, const Weights& w)
{
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(around[0].stiffness.rows(), around[0].stiffness.cols());
    double total = 0;
    for (const ProjectedAverage& average : around) {
        const double share = 1 / std::max((average.weights - w).squaredNorm(), 1e-12);
        sum += share * average.stiffness;
        total += share;
    }
    return sum / total;
}

} // namespace

AverageProjector::AverageProjector(const Energy& energy, const Subspace& subspace, const NormalizedPoses& set,
                                   Progress* progress)
    : energy_(energy)
    , subspace_(subspace)
    , set_(set)
    , progress_(progress)
{
}

std::vector<ProjectedAverage> AverageProjector::project(const std::vector<AverageAt>& averages) const
{
    SharedProgress shared(progress_);
    shared.describe("training", 0, fmt::format("stiffness at {} averages", averages.size()));
    const Eigen::MatrixXd rows = subspace_.basis.transpose();
    std::vector<std::unique_ptr<HessianAssembler>> assemblers(worker_count());
    std::vector<ProjectedAverage> out(averages.size());
    for_each_task(averages.size(), [&](std::size_t i, std::size_t worker) {
        shared.update("", 0);
        std::unique_ptr<HessianAssembler>& assembler = assemblers[worker];
        if (!assembler) assembler = std::make_unique<HessianAssembler>(energy_);
        const auto& [w, shape, is_interpolated] = averages[i];
        assembler->assemble(w, *shape, HessianKind::exact);
        const Eigen::MatrixXd forces = times_symmetric(rows, assembler->matrix()), stiffness = forces * subspace_.basis;
        out[i] = { w,
                   shape,
                   pliant::project(subspace_, *shape, set_.masses),
                   forces * (*shape - subspace_.rest),
                   0.5 * (stiffness + stiffness.transpose()),
                   energy_value(energy_, w, *shape) };
    });
    return out;
}

std::vector<ProjectedAverage> AverageProjector::project(const std::vector<AverageAt>& averages,
                                                        const std::vector<ProjectedAverage>& around) const
{
    // What lies outside of the subspace is small: its product with the Hessian is the change of the forces along a part of
    // it.
    constexpr double part = 1e-2;
    SharedProgress shared(progress_);
    shared.describe("training", 0.5, fmt::format("forces at {} averages", averages.size()));
    std::vector<ProjectedAverage> out(averages.size());
    for_each_task(averages.size(), [&](std::size_t i, std::size_t) {
        shared.update("", 0);
        const auto& [w, shape, is_interpolated] = averages[i];
        const Eigen::VectorXd nearest = pliant::project(subspace_, *shape, set_.masses);
        const Shape outside = *shape - subspace_.shape(nearest);
        Shape before = Shape::Zero(shape->size()), after = before;
        const double energy = add_gradient(energy_, w, *shape, before);
        add_gradient(energy_, w, *shape + part * outside, after);
        Eigen::MatrixXd stiffness = interpolated_stiffness(around, w);
        Eigen::VectorXd pull = stiffness * nearest + subspace_.basis.transpose() * ((after - before) / part);
        out[i] = { w, shape, nearest, std::move(pull), std::move(stiffness), energy };
    });
    return out;
}

std::vector<AverageAt> distinct_averages(const std::vector<KnownAverage>& averages, std::vector<Weights> corners)
{
    std::vector<Weights> taken = std::move(corners);
    std::vector<AverageAt> out;
    for (const KnownAverage& average : averages) {
        const bool is_near = std::any_of(taken.begin(), taken.end(), [&](const Weights& other) {
            return (other - average.weights).norm() < closest_centres;
        });
        if (is_near) continue;
        taken.push_back(average.weights);
        out.push_back({ average.weights, &average.shape, average.is_interpolated });
    }
    return out;
}

Eigen::VectorXd reduced_average(const ProjectedAverage& average, Eigen::Index d, double nearness)
{
    Eigen::MatrixXd stiffness = average.stiffness.topLeftCorner(d, d);
    stiffness.diagonal().array() += nearness;
    return stiffness.ldlt().solve(average.pull.head(d) + nearness * average.nearest.head(d));
}

TrainingSet training_of(const ReducedSolver& reduced, const std::vector<ProjectedAverage>& averages, std::size_t exact_count,
                        double nearness)
{
    const Eigen::Index d = reduced.subspace().dimension();
    TrainingSet training;
    training.exact_stiffness_count = exact_count;
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
    const bool has_layers = reduced.energy().energy().blend() == Blend::layers;
    training.energy_scale = has_layers ? reduced.energy_scale() : std::max(energy, least_energy_scale);
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
    training.energy_scale = std::max(training.energy_scale / double(training.averages.size()), least_energy_scale);
    return training;
}

} // namespace pliant
