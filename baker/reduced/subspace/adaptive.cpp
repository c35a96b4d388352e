#include "reduced/subspace/adaptive.h"

#include "base/weights/sampling.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/average/sweep.h"

#include <fmt/core.h>

namespace pliant {

namespace {

// More snapshots for a dimension that was asked for come in groups of this.
constexpr std::size_t batch_size = 8;

void add(FoundSubspace& out, std::vector<CheckPoint> points)
{
    for (CheckPoint& point : points) {
        out.unconverged_count += !point.has_converged;
        out.averages.push_back({ point.weights, std::move(point.reference) });
    }
}

} // namespace

FoundSubspace build_adaptive_subspace(const AverageFamily& family, const KnownAverage& mean,
                                      const std::vector<Weights>& training, const std::vector<Weights>& check_weights,
                                      const AdaptiveOptions& options, Progress* progress)
{
    const NormalizedPoses& set = family.pool().set();
    FoundSubspace out;
    out.averages.push_back(mean);
    add(out, sweep(family, out.averages, { training.begin() + 1, training.end() }, progress));
    Random random(options.seed);
    while (Eigen::Index(out.averages.size()) < options.dimension) {
        std::vector<Weights> batch;
        for (std::size_t i = 0; i < batch_size; ++i) batch.push_back(mixed_weights(random, set.pose_count(), i));
        add(out, sweep(family, out.averages, batch, progress));
    }
    out.checks = sweep(family, out.averages, check_weights, progress);
    if (progress) progress->update("subspace", 0.9, fmt::format("leading directions of {} snapshots", out.averages.size()));
    Eigen::MatrixXd directions(set.dof_count(), Eigen::Index(out.averages.size()));
    for (std::size_t i = 0; i < out.averages.size(); ++i)
        directions.col(Eigen::Index(i)) = out.averages[i].shape - set.shapes[0];
    out.subspace = build_subspace(set, directions, options.dimension ? options.dimension : options.max_dimension);
    return out;
}

} // namespace pliant
