#include "base/weights/sampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

Weights random_weights(Random& random, std::size_t count, bool skew)
{
    Weights w(count);
    for (Eigen::Index k = 0; k < w.size(); ++k)
        w[k] = skew ? std::pow(random.uniform(), 3) : -std::log(1 - random.uniform());
    if (w.sum() < 1e-12)
        return equal_weights(count); // all numbers were zero: practically impossible, but it must not divide
    return w / w.sum();
}

namespace {

Weights face_weights(Random& random, std::size_t pose_count)
{
    const std::vector<std::size_t> poses = random.distinct(pose_count, 3 + random.below(sparse_limit - 2));
    const Weights part = random_weights(random, poses.size(), false);
    Weights w = Weights::Zero(Eigen::Index(pose_count));
    for (std::size_t i = 0; i < poses.size(); ++i) w[Eigen::Index(poses[i])] = part[Eigen::Index(i)];
    return w;
}

} // namespace

Weights mixed_weights(Random& random, std::size_t pose_count, std::size_t index)
{
    if (pose_count > few_poses && index % 3 == 0) return face_weights(random, pose_count);
    if (pose_count == 2 || index % 3 == 0) return random_weights(random, pose_count, false);
    if (index % 3 == 2) return random_weights(random, pose_count, true);
    const std::size_t i = random.below(pose_count), j = (i + 1 + random.below(pose_count - 1)) % pose_count;
    const double t = 0.1 + 0.8 * random.uniform();
    return t * corner_weights(pose_count, i) + (1 - t) * corner_weights(pose_count, j);
}

namespace {

// Somewhere on the simplex, often on its edges and faces, where families of averages bend most.
Weights candidate_weights(Random& random, std::size_t pose_count, std::size_t index)
{
    const std::size_t members = index % 4 == 0 ? 2 : index % 4 == 1 ? 3 : pose_count;
    if (members >= pose_count) return random_weights(random, pose_count, index % 4 == 3);
    std::vector<std::size_t> poses(pose_count);
    std::iota(poses.begin(), poses.end(), std::size_t(0));
    const Weights part = random_weights(random, members, false);
    Weights w = Weights::Zero(Eigen::Index(pose_count));
    for (std::size_t i = 0; i < members; ++i) {
        std::swap(poses[i], poses[i + random.below(pose_count - i)]);
        w[Eigen::Index(poses[i])] = part[Eigen::Index(i)];
    }
    return w;
}

// The middle of the edge, the middles of its halves, and so on: those of van der Corput's sequence.
std::vector<Weights> edge_weights(std::size_t count)
{
    std::vector<Weights> out;
    for (std::size_t i = 1; out.size() < count; ++i) {
        double place = 0, bit = 0.5;
        for (std::size_t rest = i; rest > 0; rest /= 2, bit /= 2) place += bit * double(rest % 2);
        out.push_back(Eigen::Vector2d(place, 1 - place));
    }
    return out;
}

// Each the one of many candidates that is farthest from all before it and from the poses. Distances are those of the roots
// of the weights, on a sphere: they are longer near edges and corners.
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

std::vector<Weights> draw_weights(std::uint64_t seed, std::size_t pose_count, int count)
{
    Random random(seed);
    std::vector<Weights> out;
    for (int i = 0; i < count; ++i) out.push_back(mixed_weights(random, pose_count, std::size_t(i)));
    return out;
}

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

} // namespace pliant
