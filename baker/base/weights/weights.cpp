#include "base/weights/weights.h"

#include "base/common/diagnostics.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace pliant {

Weights corner_weights(std::size_t pose_count, std::size_t pose)
{
    return Weights::Unit(Eigen::Index(pose_count), Eigen::Index(pose));
}

Weights equal_weights(std::size_t pose_count)
{
    return Weights::Constant(Eigen::Index(pose_count), 1.0 / double(pose_count));
}

Weights linear_shares(const Weights& w, std::size_t pose_count)
{
    if (std::size_t(w.size()) == pose_count) return w / w.sum();
    Weights shares(w.size() + 1);
    shares << 1 - w.sum(), w;
    return shares;
}

std::string weights_text(const Weights& w)
{
    std::string text;
    for (double value : w) text += fmt::format("{}{:.3g}", text.empty() ? "" : ",", value);
    return text;
}

std::string blend_text(const Weights& w, const std::vector<std::string>& pose_names)
{
    const std::size_t count = std::size_t(w.size());
    if (pose_names.size() < count || (pose_names.size() == count && count <= few_poses)) return weights_text(w);
    const std::size_t first = pose_names.size() - count; // of layers the rest shape has no weight
    std::vector<Eigen::Index> used;
    for (Eigen::Index k = 0; k < w.size(); ++k)
        if (w[k] != 0) used.push_back(k);
    const std::size_t named = std::min(used.size(), sparse_limit);
    if (used.size() > named)
        std::stable_sort(used.begin(), used.end(),
                         [&](Eigen::Index a, Eigen::Index b) { return std::abs(w[a]) > std::abs(w[b]); });
    std::string text;
    for (std::size_t i = 0; i < named; ++i)
        text += fmt::format("{}{}={:.3g}", i == 0 ? "" : ",", pose_names[std::size_t(used[i]) + first], w[used[i]]);
    if (used.size() > named) text += fmt::format(" and {} smaller ones", used.size() - named);
    return text.empty() ? "0" : text;
}

Weights normalized_weights(const std::vector<double>& values, std::size_t pose_count)
{
    if (values.size() != pose_count)
        throw Failure(ExitCode::usage,
                      error_at(1203, "", fmt::format("{} weights given for {} poses", values.size(), pose_count),
                               "give one weight per pose, separated by commas"));
    Weights w = Eigen::Map<const Weights>(values.data(), Eigen::Index(values.size()));
    const double largest = w.maxCoeff();
    if (!w.allFinite() || w.minCoeff() < 0 || !(largest > 0))
        throw Failure(ExitCode::usage,
                      error_at(1204, "", "the weights are not all finite and non-negative with a positive sum",
                               "only their ratios matter; use 0 for poses that take no part"));
    w /= largest; // first, so that the sum of very large ones does not overflow
    return w / w.sum();
}

Weights layer_weights(const std::vector<double>& values, std::size_t layer_count)
{
    if (values.size() != layer_count)
        throw Failure(
            ExitCode::usage,
            error_at(1203, "", fmt::format("{} weights given for {} layers", values.size(), layer_count),
                     "give one weight per layer, separated by commas; the first pose is the rest shape and has none"));
    const Weights v = Eigen::Map<const Weights>(values.data(), Eigen::Index(values.size()));
    if (!v.cast<float>().allFinite()) // what the runtime takes
        throw Failure(ExitCode::usage,
                      error_at(1204, "", "the weights are not all finite numbers of single precision",
                               "0 leaves a layer out, 1 shows it whole; negative weights and weights above 1 are allowed"));
    return v;
}

} // namespace pliant
