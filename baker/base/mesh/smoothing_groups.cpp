#include "base/mesh/smoothing_groups.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

namespace pliant {

namespace {

// Cosine of 1 degree. Tools write one normal for all copies of a smooth vertex, rounded to 8 bits at the coarsest, which is
// 0.4 degrees; edges that are meant to be seen differ by far more.
constexpr double kSameDirection = 0.99984769515639124;

// Keeps the cost of a normal small: pliant_normals_init refuses groups that are too large.
constexpr std::size_t kLargest = 256;

// Only so many groups at one place, the last ones, are compared with a vertex: the cost stays linear.
constexpr std::ptrdiff_t kCandidates = 64;

// A normal shorter than this has no direction in single precision, in which files have them.
constexpr double kShortest = 1e-6;

struct Group {
    std::uint32_t first;
    std::size_t size;
};

bool agree(const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
    const double lengths = a.norm() * b.norm();
    return !(lengths > kShortest * kShortest) || a.dot(b) >= kSameDirection * lengths; // NaN has no direction either
}

// Cosine of 177 degrees. The sides of a sheet without thickness are 180 degrees apart, those of a sharp blade less.
constexpr double kOpposite = -0.9986;

bool oppose(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.dot(b) < kOpposite * a.norm() * b.norm(); }

} // namespace

std::vector<std::uint32_t> smoothing_groups(const std::vector<std::uint32_t>& welded,
                                            const std::vector<Eigen::Vector3d>& normals,
                                            const std::vector<Eigen::Vector3d>& sides)
{
    for (const auto* given : { &normals, &sides })
        if (!given->empty() && given->size() != welded.size())
            throw std::invalid_argument("smoothing_groups needs no normals or one for each vertex");
    std::vector<std::uint32_t> groups(welded.size());
    std::unordered_map<std::uint32_t, std::vector<Group>> groups_at; // a welded vertex
    for (std::uint32_t v = 0; v < welded.size(); ++v) {
        std::vector<Group>& candidates = groups_at[welded[v]];
        const auto joins = [&](const Group& group) {
            return (normals.empty() || agree(normals[group.first], normals[v]))
                && (sides.empty() || !oppose(sides[group.first], sides[v]));
        };
        const auto first = candidates.end() - std::min(kCandidates, candidates.end() - candidates.begin());
        const auto found = std::find_if(first, candidates.end(), joins);
        groups[v] = found == candidates.end() ? v : found->first;
        if (found == candidates.end())
            candidates.push_back({ v, 1 });
        else if (++found->size == kLargest)
            candidates.erase(found);
    }
    return groups;
}

bool is_trivial(const std::vector<std::uint32_t>& groups)
{
    for (std::uint32_t v = 0; v < groups.size(); ++v)
        if (groups[v] != v) return false;
    return true;
}

} // namespace pliant
