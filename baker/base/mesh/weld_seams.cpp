#include "base/mesh/weld_seams.h"

#include "base/mesh/point_tree.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace pliant {
namespace {

using Index = std::uint32_t;
using Edge = std::pair<Index, Index>; // ascending

// Those of one triangle, ascending, of parts that are joined.
std::vector<Edge> border_edges(const std::vector<Triangle>& triangles, const RoundedParts& parts,
                               const std::vector<Index>& targets)
{
    const Eigen::VectorXd least_reaches = parts.reaches.rowwise().minCoeff();
    std::vector<Edge> edges, out;
    for (const Triangle& t : triangles) {
        if (least_reaches[parts.of_vertex[t[0]]] == 0) continue;
        for (std::size_t i = 0; i < 3; ++i) {
            const Edge edge = std::minmax(Index(targets[t[i]]), Index(targets[t[(i + 1) % 3]]));
            if (edge.first != edge.second) edges.push_back(edge);
        }
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0, end; i < edges.size(); i = end) {
        end = i + 1;
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        if (end == i + 1) out.push_back(edges[i]);
    }
    return out;
}

// Ascending.
std::vector<Index> ends_of(const std::vector<Edge>& edges)
{
    std::vector<Index> out;
    for (const Edge& edge : edges) out.insert(out.end(), { edge.first, edge.second });
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

// Border vertices, numbered by their place in `border`, and the clusters that they have been joined to.
class SeamWelder {
public:
    SeamWelder(const std::vector<const Positions*>& poses, const RoundedParts& parts, const std::vector<Index>& border,
               const std::vector<Edge>& edges);

    // Each cluster to the nearest one that has other parts; false if none was joined.
    bool join_nearest(bool is_first);
    // Of the finest part.
    Index standing_for(Index i) const;

private:
    struct Pair {
        double squared_distance;
        Index a, b;
    };
    std::vector<Pair> nearest_pairs(std::size_t least_size) const;
    void leave_out_touching(std::vector<Pair>& pairs) const;
    void leave_out_layers(std::vector<Pair>& pairs) const;
    Edge parts_of(const Pair& pair) const { return std::minmax(parts_[pair.a], parts_[pair.b]); }
    Eigen::VectorXd squares_apart(Index i, Index j) const;
    bool is_near(Index i, Index j) const { return squares_apart(i, j).maxCoeff() <= 1 + 1e-9; }
    bool join(Index a, Index b);

    Eigen::MatrixXd reaches_;                 // parts x poses
    Eigen::VectorXd units_;                   // per pose the largest reach
    Eigen::MatrixXd columns_;                 // positions in all poses, in these units
    std::vector<Index> parts_;                // of each vertex
    std::vector<Edge> edges_;                 // of the border, by places
    std::vector<std::vector<Index>> members_; // of each cluster, at its first vertex
    std::vector<Index> first_;                // of the cluster of each vertex
};

SeamWelder::SeamWelder(const std::vector<const Positions*>& poses, const RoundedParts& parts,
                       const std::vector<Index>& border, const std::vector<Edge>& edges)
    : reaches_(parts.reaches)
    , units_(parts.reaches.colwise().maxCoeff())
    , columns_(3 * Eigen::Index(poses.size()), Eigen::Index(border.size()))
    , first_(border.size())
{
    std::iota(first_.begin(), first_.end(), Index(0));
    for (std::size_t i = 0; i < border.size(); ++i) {
        for (std::size_t k = 0; k < poses.size(); ++k)
            columns_.block<3, 1>(3 * Eigen::Index(k), Eigen::Index(i))
                = (poses[k]->row(border[i]) - poses[k]->row(border[0])).transpose() / units_[Eigen::Index(k)];
        parts_.push_back(parts.of_vertex[border[i]]);
        members_.push_back({ Index(i) });
    }
    const auto place
        = [&](Index v) { return static_cast<Index>(std::lower_bound(border.begin(), border.end(), v) - border.begin()); };
    for (const Edge& edge : edges) edges_.push_back({ place(edge.first), place(edge.second) }); // ascending still
}

// Of the distances of two vertices in each pose, in squares of their reaches together.
Eigen::VectorXd SeamWelder::squares_apart(Index i, Index j) const
{
    const Eigen::VectorXd apart = columns_.col(i) - columns_.col(j);
    const Eigen::VectorXd reach = (reaches_.row(parts_[i]) + reaches_.row(parts_[j])).transpose().cwiseQuotient(units_);
    const Eigen::VectorXd squares = apart.reshaped(3, reach.size()).colwise().squaredNorm();
    return squares.cwiseQuotient(reach.cwiseAbs2());
}

// Of each cluster of this size at least.
std::vector<SeamWelder::Pair> SeamWelder::nearest_pairs(std::size_t least_size) const
{
    constexpr std::size_t visit_limit = 1000; // some 100 are usual
    std::vector<TreePoint> points;
    std::vector<Index> labels;
    for (Index i = 0; i < first_.size(); ++i) {
        if (first_[i] != i || members_[i].size() < least_size) continue;
        points.push_back({ i, Index(labels.size()) });
        labels.push_back(parts_[i]);
    }
    PointTree tree(columns_, points);
    tree.relabel(labels);
    std::vector<Pair> pairs;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Index a = points[p].vertex;
        const double limit
            = (reaches_.row(parts_[a]).transpose().cwiseQuotient(units_).array() + 1).square().sum() * (1 + 1e-9);
        const Neighbour found = tree.nearest(a, labels[p], limit, visit_limit);
        if (found.point == points.size()) continue;
        const Index b = points[found.point].vertex;
        if (is_near(a, b)) pairs.push_back({ found.squared_distance, a, b });
    }
    return pairs;
}

// Seams are of edges. Borders that only touch have no edge beside each other.
void SeamWelder::leave_out_touching(std::vector<Pair>& pairs) const
{
    std::vector<Index> partners(first_.size(), Index(first_.size()));
    for (const Pair& pair : pairs) partners[pair.a] = pair.b;
    // The partner's own partner may be another one, of a third part.
    for (const Pair& pair : pairs)
        if (partners[pair.b] == first_.size()) partners[pair.b] = pair.a;
    std::vector<bool> is_of_seam(first_.size(), false);
    for (const auto& [a, b] : edges_) {
        const Edge beside = std::minmax(partners[a], partners[b]);
        if (beside.second == first_.size() || !std::binary_search(edges_.begin(), edges_.end(), beside)) continue;
        is_of_seam[a] = is_of_seam[b] = is_of_seam[beside.first] = is_of_seam[beside.second] = true;
    }
    const auto is_touching = [&](const Pair& pair) { return !is_of_seam[pair.a] || !is_of_seam[pair.b]; };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_touching), pairs.end());
}

// Copies are within a step of each other in each coordinate, and only a seam along an axis has two coordinates in which all
// of its vertices are rounded alike. What is farther apart on average are borders of layers.
void SeamWelder::leave_out_layers(std::vector<Pair>& pairs) const
{
    constexpr double greatest_mean = 0.75; // of squared distances, in any pose, in those of the reaches
    struct Sums {
        Eigen::VectorXd squares;
        double count = 0;
    };
    std::map<Edge, Sums> sums;
    for (const Pair& pair : pairs) {
        Sums& of_parts = sums[parts_of(pair)];
        if (of_parts.count == 0) of_parts.squares = Eigen::VectorXd::Zero(units_.size());
        of_parts.squares += squares_apart(pair.a, pair.b);
        ++of_parts.count;
    }
    const auto is_layer = [&](const Pair& pair) {
        const Sums& of_parts = sums[parts_of(pair)];
        return of_parts.squares.maxCoeff() > greatest_mean * of_parts.count;
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_layer), pairs.end());
}

bool SeamWelder::join_nearest(bool is_first)
{
    std::vector<Pair> pairs = nearest_pairs(is_first ? 1 : 2);
    if (is_first) {
        leave_out_touching(pairs);
        leave_out_layers(pairs);
    }
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

Index SeamWelder::standing_for(Index i) const
{
    const std::vector<Index>& members = members_[first_[i]];
    const auto coarseness = [&](Index j) { return std::pair(reaches_(parts_[j], 0), j); };
    return *std::min_element(members.begin(), members.end(),
                             [&](Index a, Index b) { return coarseness(a) < coarseness(b); });
}

} // namespace

std::size_t weld_seams(const std::vector<const Positions*>& poses, const std::vector<Triangle>& triangles,
                       const RoundedParts& parts, std::vector<Index>& targets)
{
    const std::vector<Edge> edges = border_edges(triangles, parts, targets);
    const std::vector<Index> border = ends_of(edges);
    if (border.empty()) return 0;
    SeamWelder welder(poses, parts, border, edges);
    constexpr int round_limit = 4; // the others join the clusters where four parts and more meet
    for (int round = 0; round < round_limit && welder.join_nearest(round == 0); ++round) {}
    std::size_t joined_count = 0;
    for (Index i = 0; i < border.size(); ++i) {
        const Index standing = border[welder.standing_for(i)];
        if (standing == border[i]) continue;
        targets[border[i]] = standing;
        ++joined_count;
    }
    for (Index& target : targets) target = targets[target];
    return joined_count;
}

} // namespace pliant
