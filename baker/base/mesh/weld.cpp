#include "base/mesh/weld.h"

#include "base/common/random.h"
#include "base/common/sha256.h"
#include "base/mesh/point_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>

namespace pliant {
namespace {

using Index = std::uint32_t;

// Directions that follow from all coordinates, so that nobody can lay vertices across them, where they would have equal
// heights and take quadratic time.
std::uint64_t seed_of(const std::vector<const Positions*>& poses)
{
    std::string digests;
    for (const Positions* pose : poses)
        digests += sha256_hex({ reinterpret_cast<const char*>(pose->data()), std::size_t(pose->size()) * sizeof(double) });
    return std::stoull(sha256_hex(digests).substr(0, 16), nullptr, 16);
}

class Welder {
public:
    Welder(const std::vector<const Positions*>& poses, double tolerance, Random& random)
        : poses_(poses)
        , window_(tolerance * double(poses.size()))
        , heights_(Eigen::VectorXd::Zero(poses[0]->rows()))
    {
        for (const Positions* pose : poses) {
            const Eigen::RowVector3d low = pose->colwise().minCoeff(), high = pose->colwise().maxCoeff();
            const double diagonal = (high - low).norm();
            reach_.push_back(tolerance * diagonal);
            const Eigen::Vector3d up = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
            if (diagonal > 0) heights_ += (pose->rowwise() - low) / diagonal * up;
        }
    }

    // Nothing if it takes more comparisons than `limit`. A vertex is compared with the `limit_of_vertex` centres that are
    // nearest in height.
    std::optional<std::vector<Index>> weld(std::uint64_t limit, std::uint64_t limit_of_vertex);

private:
    bool is_near(Index a, Index b) const
    {
        for (std::size_t k = 0; k < poses_.size(); ++k)
            if ((poses_[k]->row(a) - poses_[k]->row(b)).norm() > reach_[k]) return false;
        return true;
    }

    const std::vector<const Positions*>& poses_;
    double window_;
    Eigen::VectorXd heights_; // distances from planes, over the diagonals, added up over the poses
    std::vector<double> reach_;
};

// Upwards, each vertex to the centre of a cluster near it or a centre itself: no chain of short steps can join what is
// apart.
std::optional<std::vector<Index>> Welder::weld(std::uint64_t limit, std::uint64_t limit_of_vertex)
{
    std::vector<Index> order(static_cast<std::size_t>(heights_.size())), centres, centre_of(order.size());
    std::iota(order.begin(), order.end(), Index(0));
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return heights_[a] < heights_[b]; });
    const double rounding = 1e-14; // of heights, which are sums of a few numbers below 2
    for (const Index v : order) {
        centre_of[v] = v;
        std::uint64_t left = limit_of_vertex;
        for (auto c = centres.rbegin(); c != centres.rend() && heights_[v] - heights_[*c] <= window_ + rounding; ++c) {
            if (left-- == 0) break;
            if (limit-- == 0) return std::nullopt;
            if (!is_near(v, *c)) continue;
            centre_of[v] = *c;
            break;
        }
        if (centre_of[v] == v) centres.push_back(v);
    }
    // The lowest number of each cluster stands for it.
    std::vector<Index> lowest(order.size(), static_cast<Index>(order.size())), result(order.size());
    for (Index v = 0; v < order.size(); ++v) {
        Index& least = lowest[centre_of[v]];
        least = std::min(least, v);
        result[v] = least;
    }
    return result;
}

// Ascending.
std::vector<Index> border_vertices(const std::vector<Triangle>& triangles, const std::vector<Index>& targets)
{
    std::vector<std::array<Index, 2>> edges;
    for (const Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const Index a = targets[t[i]], b = targets[t[(i + 1) % 3]];
            if (a != b) edges.push_back({ std::min(a, b), std::max(a, b) });
        }
    std::sort(edges.begin(), edges.end());
    std::vector<Index> out;
    for (std::size_t i = 0, end; i < edges.size(); i = end) {
        end = i + 1;
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        if (end == i + 1) out.insert(out.end(), edges[i].begin(), edges[i].end());
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

// Border vertices, numbered by their place in `border`, and the clusters that they have been joined to.
class SeamWelder {
public:
    SeamWelder(const std::vector<const Positions*>& poses, const RoundedParts& parts, const std::vector<Index>& border)
        : columns_(3 * Eigen::Index(poses.size()), Eigen::Index(border.size()))
        , first_(border.size())
    {
        for (std::size_t i = 0; i < border.size(); ++i) {
            for (std::size_t k = 0; k < poses.size(); ++k)
                columns_.block<3, 1>(3 * Eigen::Index(k), Eigen::Index(i))
                    = (poses[k]->row(border[i]) - poses[k]->row(border[0])).transpose() / parts.reaches[k];
            parts_.push_back(parts.of_vertex[border[i]]);
            members_.push_back({ Index(i) });
        }
        std::iota(first_.begin(), first_.end(), Index(0));
    }

    // Each cluster to the nearest one that has other parts; false if none was joined.
    bool join_nearest();
    Index first_of(std::size_t i) const { return first_[i]; }

private:
    struct Pair {
        double squared_distance;
        Index a, b;
        std::pair<Index, Index> parts; // ascending
    };
    std::vector<Pair> nearest_pairs() const;
    void leave_out_layers(std::vector<Pair>& pairs) const;
    Eigen::VectorXd squares_apart(Index i, Index j) const;
    bool is_near(Index i, Index j) const { return squares_apart(i, j).maxCoeff() <= 1 + 1e-9; }
    bool join(Index a, Index b);

    Eigen::MatrixXd columns_;                 // positions in all poses, in units of the reaches
    std::vector<Index> parts_;                // of each vertex
    std::vector<std::vector<Index>> members_; // of each cluster, at its first vertex
    std::vector<Index> first_;                // of the cluster of each vertex
};

// Of the distances of two vertices in each pose.
Eigen::VectorXd SeamWelder::squares_apart(Index i, Index j) const
{
    const Eigen::VectorXd apart = columns_.col(i) - columns_.col(j);
    return apart.reshaped(3, apart.size() / 3).colwise().squaredNorm();
}

std::vector<SeamWelder::Pair> SeamWelder::nearest_pairs() const
{
    std::vector<TreePoint> points;
    std::vector<Index> labels;
    for (Index i = 0; i < first_.size(); ++i) {
        if (first_[i] != i) continue;
        points.push_back({ i, 0 });
        labels.push_back(parts_[i]);
    }
    PointTree tree(columns_, points);
    tree.relabel(labels);
    const double limit = double(columns_.rows()) / 3 + 1e-9; // a reach in every pose
    std::vector<Pair> pairs;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Neighbour found = tree.nearest(points[p].vertex, labels[p], limit);
        if (found.point == points.size()) continue;
        const Index a = points[p].vertex, b = points[found.point].vertex;
        if (is_near(a, b)) pairs.push_back({ found.squared_distance, a, b, std::minmax(parts_[a], parts_[b]) });
    }
    return pairs;
}

// Copies are within a step of each other in each coordinate, and only a seam along an axis has two coordinates in which all
// of its vertices are rounded alike. What is farther apart on average are borders of layers.
void SeamWelder::leave_out_layers(std::vector<Pair>& pairs) const
{
    constexpr double greatest_mean = 0.75; // of squared distances, in any pose, in those of the reach: 1.5 steps
    struct Sums {
        Eigen::VectorXd squares;
        double count = 0;
    };
    std::map<std::pair<Index, Index>, Sums> sums;
    for (const Pair& pair : pairs) {
        Sums& of_parts = sums[pair.parts];
        if (of_parts.count == 0) of_parts.squares = Eigen::VectorXd::Zero(columns_.rows() / 3);
        of_parts.squares += squares_apart(pair.a, pair.b);
        ++of_parts.count;
    }
    const auto is_layer = [&](const Pair& pair) {
        const Sums& of_parts = sums[pair.parts];
        return of_parts.squares.maxCoeff() > greatest_mean * of_parts.count;
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_layer), pairs.end());
}

bool SeamWelder::join_nearest()
{
    std::vector<Pair> pairs = nearest_pairs();
    leave_out_layers(pairs);
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.squared_distance < b.squared_distance; });
    bool has_joined = false;
    for (const Pair& pair : pairs) has_joined |= join(first_[pair.a], first_[pair.b]);
    return has_joined;
}

// If all of them are of different parts and near each other: no chain of short steps can join what is apart.
bool SeamWelder::join(Index a, Index b)
{
    constexpr std::size_t member_limit = 16; // more parts do not meet in a point
    if (a == b || members_[a].size() + members_[b].size() > member_limit) return false;
    for (const Index i : members_[a])
        for (const Index j : members_[b])
            if (parts_[i] == parts_[j] || !is_near(i, j)) return false;
    if (b < a) std::swap(a, b);
    for (const Index j : members_[b]) first_[j] = a;
    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
    members_[b].clear();
    return true;
}

} // namespace

std::size_t weld_seams(const std::vector<const Positions*>& poses, const std::vector<Triangle>& triangles,
                       const RoundedParts& parts, std::vector<Index>& targets)
{
    const std::vector<Index> border = border_vertices(triangles, targets);
    if (border.empty()) return 0;
    SeamWelder welder(poses, parts, border);
    constexpr int round_limit = 8; // the second joins the pairs of points where four parts meet
    for (int round = 0; round < round_limit && welder.join_nearest(); ++round) {}
    std::size_t joined_count = 0;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const Index first = border[welder.first_of(i)];
        if (first == border[i]) continue;
        targets[border[i]] = first;
        ++joined_count;
    }
    for (Index& target : targets) target = targets[target];
    return joined_count;
}

std::vector<Index> weld(const std::vector<const Positions*>& poses, double tolerance)
{
    constexpr std::uint64_t mean_limit = 64; // comparisons of a vertex
    if (tolerance > 0) {
        Random random(seed_of(poses));
        // A mesh may lie across the directions by chance: then others are tried.
        for (int attempt = 0; attempt < 8; ++attempt)
            if (auto result
                = Welder(poses, tolerance, random).weld(mean_limit * std::uint64_t(poses[0]->rows()), UINT64_MAX))
                return std::move(*result);
        return *Welder(poses, tolerance, random).weld(UINT64_MAX, mean_limit);
    }
    std::vector<Index> result(static_cast<std::size_t>(poses[0]->rows()));
    std::iota(result.begin(), result.end(), Index(0));
    return result;
}

} // namespace pliant
