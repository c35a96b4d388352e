#include "output/asset/reachable.h"

namespace pliant {

namespace {

// Enough that with 12 poses each of the 66 edges gets ten.
constexpr std::size_t range_sample_count = 2000;
constexpr std::uint64_t range_seed = 7919;
// What lies between the samples, and the last digits of a solve that comes from another side.
constexpr float range_margin = 0.05f;
} // namespace

Eigen::MatrixXf blend_coordinates(RuntimeBlender& blender, const std::vector<std::vector<float>>& weights)
{
    Eigen::MatrixXf all(blender.asset().dimension, Eigen::Index(weights.size()));
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const std::vector<float> q = blender.solve(weights[i], false);
        all.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size()));
    }
    return all;
}

namespace {

// From pose to pose in steps that a solver takes for one motion (pliant_solver_desc.continuity): it may stay behind a cold
// solve.
constexpr int path_steps = 24;

// Coordinates on the way from each pose to each other, and to and from the mean, every frame going on from the one before.
Eigen::MatrixXf path_ranges(RuntimeBlender& blender)
{
    const WeightDomain domain = blender.domain();
    const std::vector<std::vector<float>> stops = domain.covering(0, range_seed); // the centre last
    const std::size_t centre = stops.size() - 1;
    Eigen::MatrixXf ends(blender.asset().dimension, 2);
    ends.colwise() = blend_coordinates(blender, { stops[0] }).col(0);
    std::vector<float> weights(stops[0].size());
    // Layers are switched on and off one by one, and there may be many pairs of poses.
    const auto is_path = [&](std::size_t from, std::size_t to) {
        return from != to && (!domain.is_wide() || from == centre || to == centre);
    };
    for (std::size_t from = 0; from < stops.size(); ++from)
        for (std::size_t to = 0; to < stops.size(); ++to)
            for (int step = 0; step <= path_steps && is_path(from, to); ++step) {
                const float t = float(step) / float(path_steps);
                for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = (1 - t) * stops[from][k] + t * stops[to][k];
                const std::vector<float> q = blender.solve(weights, step != 0);
                const auto found = Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size()));
                ends.col(0) = ends.col(0).cwiseMin(found);
                ends.col(1) = ends.col(1).cwiseMax(found);
            }
    return ends;
}

} // namespace

MorphRanges ranges_of(const Eigen::MatrixXf& coordinates, float margin)
{
    MorphRanges ranges { coordinates.rowwise().minCoeff(), coordinates.rowwise().maxCoeff() };
    const Eigen::VectorXf extra = margin * (ranges.high - ranges.low);
    ranges.low -= extra;
    ranges.high += extra;
    return ranges;
}

MorphRanges find_morph_ranges(RuntimeBlender& blender)
{
    const Eigen::MatrixXf cold = blend_coordinates(blender, blender.domain().covering(range_sample_count, range_seed)),
                          warm = path_ranges(blender);
    Eigen::MatrixXf all(cold.rows(), cold.cols() + warm.cols());
    all << cold, warm;
    return ranges_of(all, range_margin);
}

const float* stored_morph_ranges(const RuntimeBlender& blender) { return blender.asset().morph_ranges; }

} // namespace pliant
