#include "write/reachable.h"

#include "reduce/training.h"

namespace pliant {

namespace {

// Enough that on 12 poses each of the 66 edges gets ten; on the bodies at hand twice as many move no range by more than a fifth of the
// margin (tests/export/test_ranges.cpp repeats that on a small one).
constexpr std::size_t range_sample_count = 2000;
constexpr std::uint64_t range_seed = 7919;
// What lies between the samples, and the last digits of a solve that comes from another side.
constexpr float range_margin = 0.05f;

} // namespace

std::vector<std::vector<float>> covering_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed)
{
    std::vector<std::vector<float>> all;
    for (std::size_t k = 0; k < pose_count; ++k) {
        all.emplace_back(pose_count, 0.0f);
        all.back()[k] = 1.0f;
    }
    all.emplace_back(pose_count, 1.0f / float(pose_count));
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::VectorXf w = mixed_weights(random, pose_count, i).cast<float>();
        all.emplace_back(w.data(), w.data() + w.size());
    }
    return all;
}

Eigen::MatrixXf blend_coordinates(RuntimeBlender& blender, const std::vector<std::vector<float>>& weights)
{
    Eigen::MatrixXf all(blender.asset().dimension, Eigen::Index(weights.size()));
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const std::vector<float> q = blender.solve(weights[i], false);
        all.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size()));
    }
    return all;
}

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
    const auto weights = covering_weights(blender.asset().pose_count, range_sample_count, range_seed);
    return ranges_of(blend_coordinates(blender, weights), range_margin);
}

const float* stored_morph_ranges(const RuntimeBlender& blender) { return blender.asset().morph_ranges; }

} // namespace pliant
