#include "elastic/parts/part_tree.h"

#include "base/common/union_find.h"
#include "base/mesh/point_tree.h"

#include <algorithm>
#include <tuple>

namespace pliant {
namespace {

// A possible edge of the tree. Ties in distance are broken by the part numbers, so that the tree is unique.
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

// Boruvka's algorithm: in each round every group of connected parts selects its shortest link to another group.
class SpanningTree {
public:
    SpanningTree(const Parts& parts, const std::vector<bool>& can_be_parent, const PartPoints& points)
        : points_(points)
        , surface_(points.columns, points_of(points, can_be_parent))
        , vertices_(points.columns, vertices_among(surface_.points(), points))
        , groups_(parts.surface_count)
        , labels_(parts.surface_count)
    {
    }

    std::vector<Link> find(std::size_t part_count)
    {
        std::vector<Link> links;
        while (links.size() + 1 < part_count) {
            for (std::size_t p = 0; p < labels_.size(); ++p) labels_[p] = std::uint32_t(groups_.find(std::uint32_t(p)));
            surface_.relabel(labels_);
            vertices_.relabel(labels_);
            add(shortest_links(), links);
        }
        return links;
    }

private:
    // Per group, at its label. Vertices are compared with the surfaces of other groups, sample points of faces with their
    // vertices.
    std::vector<Link> shortest_links() const
    {
        std::vector<Link> best(labels_.size());
        for (const TreePoint& point : surface_.points()) {
            const PointTree& tree = points_.faces[point.vertex] == no_face ? surface_ : vertices_;
            Link& link = best[labels_[point.label]];
            const Neighbour found = tree.nearest(point.vertex, labels_[point.label], link.squared_distance);
            if (found.point == tree.points().size()) continue;
            // Ordered part numbers: two groups that choose each other must choose the same link.
            const std::size_t a = point.label, b = tree.points()[found.point].label;
            const Link candidate { found.squared_distance, std::min(a, b), std::max(a, b) };
            if (candidate < link) link = candidate;
        }
        return best;
    }

    void add(std::vector<Link> best, std::vector<Link>& links)
    {
        std::sort(best.begin(), best.end());
        for (const Link& link : best) {
            if (link.from == no_part || groups_.find(std::uint32_t(link.from)) == groups_.find(std::uint32_t(link.to)))
                continue;
            groups_.join(std::uint32_t(link.from), std::uint32_t(link.to));
            links.push_back(link);
        }
    }

    const PartPoints& points_;
    PointTree surface_, vertices_;
    UnionFind groups_;
    std::vector<std::uint32_t> labels_; // the group of each part
};

std::size_t heaviest_part(const Parts& parts, const std::vector<bool>& can_be_parent, const Eigen::VectorXd& masses)
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

// Breadth first from the root along the links.
void orient_links(const std::vector<Link>& links, std::size_t root, std::size_t part_count, PartTree& tree)
{
    std::vector<std::vector<std::size_t>> neighbours(part_count);
    for (const Link& link : links) {
        neighbours[link.from].push_back(link.to);
        neighbours[link.to].push_back(link.from);
    }
    tree.order.push_back(root);
    for (std::size_t i = 0; i < tree.order.size(); ++i) {
        const std::size_t part = tree.order[i];
        std::sort(neighbours[part].begin(), neighbours[part].end());
        for (const std::size_t next : neighbours[part]) {
            if (next == tree.parents[part]) continue;
            tree.parents[next] = part;
            tree.order.push_back(next);
        }
    }
}

// Attaches the parts that cannot be parents: single vertices, and parts that collapse to a line in some pose.
void connect_leaves(const Parts& parts, const std::vector<bool>& can_be_parent, const PartPoints& points, PartTree& out)
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
    const std::size_t parent_count = std::size_t(std::count(can_be_parent.begin(), can_be_parent.end(), true));
    const std::vector<Link> links = SpanningTree(parts, can_be_parent, points).find(parent_count);
    orient_links(links, heaviest_part(parts, can_be_parent, masses), parts.surface_count, tree);
    connect_leaves(parts, can_be_parent, points, tree);
    return tree;
}

} // namespace pliant
