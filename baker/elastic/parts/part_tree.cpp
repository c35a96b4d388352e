#include "elastic/parts/part_tree.h"

#include "base/common/union_find.h"
#include "base/mesh/point_tree.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace pliant {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Link {
    double squared_distance = infinity;
    std::size_t from = no_part, to = no_part; // parts

    bool operator<(const Link& other) const
    {
        return std::tie(squared_distance, from, to) < std::tie(other.squared_distance, other.from, other.to);
    }
};

std::vector<TreePoint> points_of(const PartPoints& points, const std::vector<bool>& can_be_parent)
{
    std::vector<TreePoint> out;
    for (std::size_t p = 0; p < can_be_parent.size(); ++p)
        if (can_be_parent[p])
            for (const std::uint32_t column : points.of_part[p]) out.push_back({ column, std::uint32_t(p) });
    return out;
}

std::vector<TreePoint> vertices_among(std::vector<TreePoint> tree_points, const PartPoints& points)
{
    const auto is_of_face = [&](const TreePoint& point) { return points.faces[point.vertex] != no_face; };
    tree_points.erase(std::remove_if(tree_points.begin(), tree_points.end(), is_of_face), tree_points.end());
    return tree_points;
}

// The shortest links that make one of all parts that can hold others: every group of parts looks for its nearest neighbour, all at once, until
// there is one group.
std::vector<Link> shortest_links(const Parts& parts, const std::vector<bool>& can_be_parent, const PartPoints& points)
{
    const std::size_t count = std::size_t(std::count(can_be_parent.begin(), can_be_parent.end(), true));
    PointTree surface(points.columns, points_of(points, can_be_parent));
    PointTree vertices(points.columns, vertices_among(surface.points(), points));
    UnionFind groups(parts.surface_count);
    std::vector<std::uint32_t> labels(parts.surface_count);
    std::vector<Link> links;
    while (links.size() + 1 < count) {
        for (std::size_t p = 0; p < labels.size(); ++p) labels[p] = std::uint32_t(groups.find(std::uint32_t(p)));
        surface.relabel(labels);
        vertices.relabel(labels);
        std::vector<Link> best(parts.surface_count); // of a group, at its label
        for (const TreePoint& point : surface.points()) {
            const PointTree& tree = points.faces[point.vertex] == no_face ? surface : vertices;
            Link& link = best[labels[point.label]];
            const Neighbour found = tree.nearest(point.vertex, labels[point.label], link.squared_distance);
            if (found.point == tree.points().size()) continue;
            // The same from both sides: groups that choose each other must choose the same link.
            const std::size_t a = point.label, b = tree.points()[found.point].label;
            const Link candidate { found.squared_distance, std::min(a, b), std::max(a, b) };
            if (candidate < link) link = candidate;
        }
        std::sort(best.begin(), best.end());
        for (const Link& link : best) {
            if (link.from == no_part || groups.find(std::uint32_t(link.from)) == groups.find(std::uint32_t(link.to)))
                continue;
            groups.join(std::uint32_t(link.from), std::uint32_t(link.to));
            links.push_back(link);
        }
    }
    return links;
}

std::size_t heaviest(const Parts& parts, const std::vector<bool>& can_be_parent, const Eigen::VectorXd& masses)
{
    std::size_t root = 0;
    double most = -1;
    for (std::size_t p = 0; p < parts.surface_count; ++p) {
        if (!can_be_parent[p]) continue;
        double mass = 0;
        for (const std::uint32_t v : parts.vertices[p]) mass += masses[v];
        if (mass > most) most = mass, root = p;
    }
    return root;
}

// The others hang on what is nearest: single vertices, and parts that are a line in some pose.
void connect_others(const Parts& parts, const std::vector<bool>& can_be_parent, const PartPoints& points, PartTree& out)
{
    if (out.order.size() == parts.count()) return;
    const PointTree tree(points.columns, points_of(points, can_be_parent));
    for (std::size_t p = 0; p < parts.count(); ++p) {
        if (can_be_parent[p]) continue;
        Link best;
        for (const std::uint32_t column : points.of_part[p]) {
            const Neighbour found = tree.nearest(column, 1, best.squared_distance);
            if (found.point < tree.points().size()) best = { found.squared_distance, p, tree.points()[found.point].label };
        }
        out.parents[p] = best.to;
        out.order.push_back(p);
    }
}

} // namespace

PartTree connect_parts(const Parts& parts, const std::vector<bool>& can_be_parent, const PartPoints& points,
                       const Eigen::VectorXd& masses)
{
    PartTree tree;
    tree.parents.assign(parts.count(), no_part);
    if (parts.surface_count == 0) return tree;
    std::vector<std::vector<std::size_t>> neighbours(parts.surface_count);
    for (const Link& link : shortest_links(parts, can_be_parent, points)) {
        neighbours[link.from].push_back(link.to);
        neighbours[link.to].push_back(link.from);
    }
    tree.order.push_back(heaviest(parts, can_be_parent, masses));
    for (std::size_t i = 0; i < tree.order.size(); ++i) {
        const std::size_t part = tree.order[i];
        std::sort(neighbours[part].begin(), neighbours[part].end());
        for (const std::size_t next : neighbours[part]) {
            if (next == tree.parents[part]) continue;
            tree.parents[next] = part;
            tree.order.push_back(next);
        }
    }
    connect_others(parts, can_be_parent, points, tree);
    return tree;
}

} // namespace pliant
