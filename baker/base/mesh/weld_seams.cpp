#include "base/mesh/weld_seams.h"

#include "base/mesh/point_tree.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace pliant {
namespace {

using Index = std::uint32_t;
using Edge = std::pair<Index, Index>; // ascending

constexpr std::size_t near_limit = 16; // vertices that one is joined with; 1 to 5 are usual
constexpr double nearness = 1 + 1e-9;  // of squared distances, in squares of the reaches

struct BorderEdge {
    Edge ends;
    Index part = 0; // of its first triangle; weld() may have joined its ends to those of another part

    bool operator<(const BorderEdge& other) const { return std::tie(ends, part) < std::tie(other.ends, other.part); }
};

// An edge of a triangle, and the corner across.
struct EdgeSide {
    BorderEdge edge;
    Index across = 0;

    bool operator<(const EdgeSide& other) const { return std::tie(edge, across) < std::tie(other.edge, other.across); }
};

// Of triangles of parts that are joined, with a corner in each of three places. Ascending.
std::vector<EdgeSide> edge_sides(const std::vector<Triangle>& triangles, const RoundedParts& parts,
                                 const std::vector<Index>& targets)
{
    const Eigen::VectorXd least_reaches = parts.reaches.rowwise().minCoeff();
    std::vector<EdgeSide> sides;
    for (const Triangle& t : triangles) {
        const Index part = parts.of_vertex[t[0]], a = targets[t[0]], b = targets[t[1]], c = targets[t[2]];
        if (least_reaches[part] <= 0 || a == b || b == c || c == a) continue;
        sides.push_back({ { std::minmax(a, b), part }, c });
        sides.push_back({ { std::minmax(b, c), part }, a });
        sides.push_back({ { std::minmax(c, a), part }, b });
    }
    std::sort(sides.begin(), sides.end());
    return sides;
}

// Whether the corners lie on one side of the edge, seen along it: that of one triangle, or those of several drawn over each
// other, such as a sheet and its back, which may be cut along other diagonals. Edges of a solid that are sharper than the
// limit are taken for borders, too.
bool is_border(const EdgeSide* begin, const EdgeSide* end, const Positions& positions)
{
    constexpr double least_cosine = 0.866; // of 30 degrees
    const Eigen::RowVector3d start = positions.row(begin->edge.ends.first);
    const Eigen::RowVector3d along = (positions.row(begin->edge.ends.second) - start).normalized();
    const auto direction = [&](const EdgeSide& side) {
        const Eigen::RowVector3d to = positions.row(side.across) - start;
        return Eigen::RowVector3d(to - to.dot(along) * along);
    };
    const Eigen::RowVector3d first = direction(*begin);
    return std::all_of(begin + 1, end, [&](const EdgeSide& side) {
        const Eigen::RowVector3d other = direction(side);
        return first.dot(other) > least_cosine * first.norm() * other.norm();
    });
}

// Ascending.
std::vector<BorderEdge> border_edges(const std::vector<EdgeSide>& sides, const Positions& positions)
{
    std::vector<BorderEdge> out;
    for (auto begin = sides.begin(), end = begin; begin != sides.end(); begin = end) {
        const Edge ends = begin->edge.ends;
        end = std::find_if(begin, sides.end(), [&](const EdgeSide& side) { return side.edge.ends != ends; });
        if (is_border(&*begin, &*begin + (end - begin), positions)) out.push_back(begin->edge);
    }
    return out;
}

// Ascending.
std::vector<Index> ends_of(const std::vector<BorderEdge>& edges)
{
    std::vector<Index> out;
    for (const BorderEdge& edge : edges) out.insert(out.end(), { edge.ends.first, edge.ends.second });
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

// Border vertices, numbered by their place in `border`, and the clusters that they are joined to.
class SeamWelder {
public:
    SeamWelder(const std::vector<const Positions*>& poses, const RoundedParts& parts, const std::vector<Index>& border,
               const std::vector<BorderEdge>& edges);

    void join_all();
    // Of the finest part.
    Index standing_for(Index i) const;

private:
    struct Pair {
        double distance; // squared, in the pose where it is greatest
        Index a, b;
    };
    using NearOnes = std::vector<std::vector<std::pair<Index, std::size_t>>>; // of each vertex: another one, and their pair
    std::vector<Pair> near_pairs() const;
    NearOnes near_ones(const std::vector<Pair>& pairs) const;
    bool is_edge_beside(const BorderEdge& edge, Index c, Index d) const;
    void leave_out_touching(std::vector<Pair>& pairs) const;
    void leave_out_layers(std::vector<Pair>& pairs) const;
    double square_apart(Index i, Index j, Eigen::Index pose) const;
    double farthest_apart(Index i, Index j) const;
    void join(Index a, Index b);

    Eigen::VectorXd units_;                   // per pose the largest reach
    Eigen::MatrixXd reaches_;                 // poses x parts, in these units
    Eigen::MatrixXd columns_;                 // positions in all poses, in these units
    std::vector<Index> parts_;                // of each vertex
    std::vector<BorderEdge> edges_;           // their ends are places; ascending
    std::vector<std::size_t> first_edge_;     // of those that begin at each vertex, and one past the last edge
    std::vector<std::vector<Index>> members_; // of each cluster, at its first vertex
    std::vector<Index> first_;                // of the cluster of each vertex
};

SeamWelder::SeamWelder(const std::vector<const Positions*>& poses, const RoundedParts& parts,
                       const std::vector<Index>& border, const std::vector<BorderEdge>& edges)
    : units_(parts.reaches.colwise().maxCoeff())
    , reaches_(units_.cwiseInverse().asDiagonal() * parts.reaches.transpose())
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
    for (const BorderEdge& edge : edges) // ascending still
        edges_.push_back({ { place(edge.ends.first), place(edge.ends.second) }, edge.part });
    for (Index v = 0; v <= border.size(); ++v) {
        std::size_t i = v == 0 ? 0 : first_edge_.back();
        while (i < edges_.size() && edges_[i].ends.first < v) ++i;
        first_edge_.push_back(i);
    }
}

// Of two vertices in a pose, in squares of their reaches together.
double SeamWelder::square_apart(Index i, Index j, Eigen::Index pose) const
{
    const double reach = reaches_(pose, parts_[i]) + reaches_(pose, parts_[j]);
    const auto place = [&](Index v) { return columns_.block<3, 1>(3 * pose, v); };
    return (place(i) - place(j)).squaredNorm() / (reach * reach);
}

// In the pose where it is greatest.
double SeamWelder::farthest_apart(Index i, Index j) const
{
    double farthest = 0;
    for (Eigen::Index k = 0; k < units_.size(); ++k) farthest = std::max(farthest, square_apart(i, j, k));
    return farthest;
}

// A vertex searches the reach of two parts as coarse as its own. A coarser partner finds it by its own search.
std::vector<SeamWelder::Pair> SeamWelder::near_pairs() const
{
    constexpr std::size_t visit_limit = 150; // some 30 are usual
    std::vector<TreePoint> points;
    for (Index i = 0; i < first_.size(); ++i) points.push_back({ i, 0 });
    const PointTree tree(columns_, points);
    std::vector<Pair> pairs;
    for (Index a = 0; a < first_.size(); ++a) {
        const double radius = 2 * reaches_.col(parts_[a]).norm() * (1 + 1e-9);
        std::vector<Pair> found;
        for (const Index b : tree.ball(columns_.col(a), radius, 0, visit_limit)) {
            if (parts_[a] == parts_[b]) continue;
            const double distance = farthest_apart(a, b);
            if (distance <= nearness) found.push_back({ distance, std::min(a, b), std::max(a, b) });
        }
        std::sort(found.begin(), found.end(), [](const Pair& p, const Pair& q) {
            return std::tie(p.distance, p.a, p.b) < std::tie(q.distance, q.a, q.b);
        });
        pairs.insert(pairs.end(), found.begin(), found.begin() + std::ptrdiff_t(std::min(found.size(), near_limit)));
    }
    const auto key = [](const Pair& pair) { return std::tie(pair.distance, pair.a, pair.b); };
    std::sort(pairs.begin(), pairs.end(), [&](const Pair& p, const Pair& q) { return key(p) < key(q); });
    pairs.erase(std::unique(pairs.begin(), pairs.end(), [&](const Pair& p, const Pair& q) { return key(p) == key(q); }),
                pairs.end());
    return pairs;
}

// Of each vertex the nearest, and first itself: weld() may have joined its copies. No pair is of a vertex and itself: its
// number is the number of pairs.
SeamWelder::NearOnes SeamWelder::near_ones(const std::vector<Pair>& pairs) const
{
    NearOnes out(first_.size());
    for (Index v = 0; v < first_.size(); ++v) out[v].push_back({ v, pairs.size() });
    const auto add = [&](Index to, Index other, std::size_t pair) {
        if (out[to].size() <= near_limit) out[to].push_back({ other, pair });
    };
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        add(pairs[i].a, pairs[i].b, i);
        add(pairs[i].b, pairs[i].a, i);
    }
    return out;
}

// An edge of another part.
bool SeamWelder::is_edge_beside(const BorderEdge& edge, Index c, Index d) const
{
    const BorderEdge sought { std::minmax(c, d), 0 };
    const auto begin = edges_.begin() + std::ptrdiff_t(first_edge_[sought.ends.first]);
    const auto end = edges_.begin() + std::ptrdiff_t(first_edge_[sought.ends.first + 1]);
    const auto found = std::lower_bound(begin, end, sought);
    return found != end && found->ends == sought.ends && found->part != edge.part;
}

// A seam joins edges. Borders that only touch have no two edges beside each other.
void SeamWelder::leave_out_touching(std::vector<Pair>& pairs) const
{
    const NearOnes near = near_ones(pairs);
    std::vector<bool> is_of_seam(pairs.size() + 1, false);
    for (const BorderEdge& edge : edges_)
        for (const auto& [c, beside_first] : near[edge.ends.first])
            for (const auto& [d, beside_second] : near[edge.ends.second]) {
                if (!is_edge_beside(edge, c, d)) continue;
                is_of_seam[beside_first] = is_of_seam[beside_second] = true;
            }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (is_of_seam[i]) pairs[kept++] = pairs[i];
    pairs.resize(kept);
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
    std::set<Edge> seen; // a vertex and the part that its nearest one is of
    const auto parts_of = [&](const Pair& pair) { return Edge(std::minmax(parts_[pair.a], parts_[pair.b])); };
    for (const Pair& pair : pairs) {
        const bool is_nearest = seen.insert({ pair.a, parts_[pair.b] }).second;
        if (!(seen.insert({ pair.b, parts_[pair.a] }).second || is_nearest)) continue;
        Sums& of_parts = sums[parts_of(pair)];
        if (of_parts.count == 0) of_parts.squares = Eigen::VectorXd::Zero(units_.size());
        for (Eigen::Index k = 0; k < units_.size(); ++k) of_parts.squares[k] += square_apart(pair.a, pair.b, k);
        ++of_parts.count;
    }
    const auto is_layer = [&](const Pair& pair) {
        const Sums& of_parts = sums[parts_of(pair)];
        return of_parts.squares.maxCoeff() > greatest_mean * of_parts.count;
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_layer), pairs.end());
}

// The nearest first.
void SeamWelder::join_all()
{
    std::vector<Pair> pairs = near_pairs();
    leave_out_touching(pairs);
    leave_out_layers(pairs);
    for (const Pair& pair : pairs) join(first_[pair.a], first_[pair.b]);
}

// If all of them are of different parts and near each other: no chain of short steps can join what is apart.
void SeamWelder::join(Index a, Index b)
{
    constexpr std::size_t member_limit = 16; // more parts do not meet in a point
    if (a == b || members_[a].size() + members_[b].size() > member_limit) return;
    for (const Index i : members_[a])
        for (const Index j : members_[b])
            if (parts_[i] == parts_[j] || farthest_apart(i, j) > nearness) return;
    if (b < a) std::swap(a, b);
    for (const Index j : members_[b]) first_[j] = a;
    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
    members_[b].clear();
}

Index SeamWelder::standing_for(Index i) const
{
    const std::vector<Index>& members = members_[first_[i]];
    const auto coarseness = [&](Index j) { return std::pair(reaches_(0, parts_[j]), j); };
    return *std::min_element(members.begin(), members.end(),
                             [&](Index a, Index b) { return coarseness(a) < coarseness(b); });
}

} // namespace

std::size_t weld_seams(const std::vector<const Positions*>& poses, const std::vector<Triangle>& triangles,
                       const RoundedParts& parts, std::vector<Index>& targets)
{
    const std::vector<BorderEdge> edges = border_edges(edge_sides(triangles, parts, targets), *poses[0]);
    const std::vector<Index> border = ends_of(edges);
    if (border.empty()) return 0;
    SeamWelder welder(poses, parts, border, edges);
    welder.join_all();
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
