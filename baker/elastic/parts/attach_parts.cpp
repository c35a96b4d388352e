#include "elastic/parts/attach_parts.h"

#include "elastic/parts/anchors.h"
#include "elastic/parts/part_points.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace pliant {

namespace {

// Lengths in units of the diagonal: the distance between tied vertices; how much farther from the parent than the nearest
// vertex a tied one may be; and the spacing of sample points on large faces.
constexpr double tie_spacing = 0.03, near_margin = 0.02, point_spacing = 0.01;

// Tied vertices of a part, if it has as many: enough to resist rotation with some to spare, and few enough to stay cheap
// beside the part's own elements.
constexpr std::size_t min_ties = 12, max_ties = 400;

// This share of a part's vertices, the nearest ones, may always be tied: a coat that hangs on the shoulders.
constexpr double near_share = 0.25;

// The parts that can anchor ties. If there is none, all parts with faces.
std::vector<bool> find_possible_parents(const NormalizedPoses& set, const Parts& parts, const Eigen::MatrixXd& columns)
{
    std::vector<bool> out(parts.count(), false);
    for (std::size_t p = 0; p < parts.surface_count; ++p)
        out[p] = can_anchor(set, parts.vertices[p], columns, poor_triangle);
    if (std::find(out.begin(), out.end(), true) == out.end())
        std::fill(out.begin(), out.begin() + std::ptrdiff_t(parts.surface_count), true);
    return out;
}

// Vertices of one part and their distances from another.
struct NearVertices {
    std::vector<std::uint32_t> vertices;
    std::vector<double> distances;

    // The distance of the i-th nearest, or of the farthest if there are fewer.
    double nearest(std::size_t i) const
    {
        std::vector<double> sorted = distances;
        std::sort(sorted.begin(), sorted.end());
        return sorted[std::min(i, sorted.size() - 1)];
    }
};

// All these vertices, with their distances from the surface of another part.
NearVertices measure_vertices(const std::vector<std::uint32_t>& vertices, const PartTrees& other)
{
    NearVertices out = { vertices, {} };
    for (const std::uint32_t v : vertices)
        out.distances.push_back(std::sqrt(other.surface.nearest(v, 1, infinity).squared_distance));
    return out;
}

// The vertices of a part that are nearest to these points of another. Not more of them than points, so that many parts on
// one parent stay cheap.
NearVertices nearest_vertices(const PartTrees& part, const std::vector<std::uint32_t>& points)
{
    std::vector<std::pair<std::uint32_t, double>> found;
    for (const std::uint32_t column : points) {
        const Neighbour nearest = part.vertices.nearest(column, 1, infinity);
        found.emplace_back(part.vertices.points()[nearest.point].vertex, std::sqrt(nearest.squared_distance));
    }
    std::sort(found.begin(), found.end());
    NearVertices out;
    for (const auto& [vertex, distance] : found) {
        if (!out.vertices.empty() && out.vertices.back() == vertex) continue;
        out.vertices.push_back(vertex);
        out.distances.push_back(distance);
    }
    return out;
}

std::vector<TreePoint> tree_points(const std::vector<std::uint32_t>& columns)
{
    std::vector<TreePoint> out;
    for (const std::uint32_t column : columns) out.push_back({ column, 0 });
    return out;
}

double box_diagonal(const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns)
{
    Eigen::VectorXd low = columns.col(vertices[0]), high = low;
    for (const std::uint32_t v : vertices) low = low.cwiseMin(columns.col(v)), high = high.cwiseMax(columns.col(v));
    return (high - low).norm();
}

class PartAttacher {
public:
    PartAttacher(const NormalizedPoses& set, const PartPoints& points, TieSet& out)
        : set_(set)
        , points_(points)
        , columns_(points.columns)
        , out_(out)
        , trees_(out.parts.surface_count)
    {
    }

    void attach(std::size_t part)
    {
        const std::size_t parent = out_.tree.parents[part];
        if (parent == no_part) return;
        const NearVertices own = measure_vertices(out_.parts.vertices[part], trees(parent));
        out_.distances[part] = own.nearest(0);
        if (!attach_parent_to(part, own)) tie_vertices(part, select_spread(own), trees(parent));
    }

private:
    // A plate on a small post touches it far from all its own corners. There the vertices of the parent, the post, are tied
    // to the part. Returns whether that was better and possible.
    bool attach_parent_to(std::size_t part, const NearVertices& own)
    {
        const double margin = near_margin * set_.diagonal;
        if (part >= out_.parts.surface_count || own.nearest(2) <= margin) return false;
        const NearVertices parents = nearest_vertices(trees(out_.tree.parents[part]), points_.of_part[part]);
        out_.distances[part] = std::min(own.nearest(0), parents.nearest(0));
        const std::vector<std::uint32_t> selected = select_spread(parents);
        return parents.nearest(2) + margin < own.nearest(2) && can_anchor(set_, selected, columns_, good_triangle)
            && tie_vertices(part, selected, trees(part));
    }

    // Returns whether it made a tie.
    bool tie_vertices(std::size_t part, const std::vector<std::uint32_t>& vertices, const PartTrees& anchors)
    {
        const std::size_t before = out_.ties.size();
        for (const std::uint32_t v : vertices)
            if (const std::optional<Tie> tie = tie_vertex(set_, columns_, part, v, anchors)) out_.ties.push_back(*tie);
        return out_.ties.size() > before;
    }

    // Built at the first use.
    const PartTrees& trees(std::size_t part)
    {
        if (!trees_[part]) {
            const std::vector<std::uint32_t>& vertices = out_.parts.vertices[part];
            trees_[part] = std::make_unique<PartTrees>(PartTrees { { columns_, tree_points(points_.of_part[part]) },
                                                                   { columns_, tree_points(vertices) },
                                                                   box_diagonal(vertices, columns_) });
        }
        return *trees_[part];
    }

    // Farthest-point sampling among the vertices within reach, starting with the nearest one.
    std::vector<std::uint32_t> select_spread(const NearVertices& near) const
    {
        std::vector<double> gaps = initial_gaps(near); // to the nearest selected vertex
        std::vector<std::uint32_t> selected;
        std::size_t next
            = std::size_t(std::min_element(near.distances.begin(), near.distances.end()) - near.distances.begin());
        while (selected.size() < max_ties) {
            selected.push_back(near.vertices[next]);
            for (std::size_t i = 0; i < gaps.size(); ++i)
                if (gaps[i] > 0)
                    gaps[i] = std::min(gaps[i], (columns_.col(near.vertices[i]) - columns_.col(selected.back())).norm());
            next = std::size_t(std::max_element(gaps.begin(), gaps.end()) - gaps.begin());
            if (!(gaps[next] > 0) || (selected.size() >= min_ties && gaps[next] < tie_spacing * set_.diagonal)) break;
        }
        return selected;
    }

    // Infinite for vertices within reach, negative for the others.
    std::vector<double> initial_gaps(const NearVertices& near) const
    {
        const std::size_t quarter = std::size_t(near_share * double(near.vertices.size()));
        const double reach
            = std::max({ near.nearest(0) + near_margin * set_.diagonal, near.nearest(quarter), near.nearest(min_ties) });
        std::vector<double> gaps;
        for (const double distance : near.distances) gaps.push_back(distance <= reach ? infinity : -1);
        return gaps;
    }

    const NormalizedPoses& set_;
    const PartPoints& points_;
    const Eigen::MatrixXd& columns_;
    TieSet& out_;
    std::vector<std::unique_ptr<PartTrees>> trees_; // per part with faces
};

} // namespace

void attach_parts(const NormalizedPoses& set, const Eigen::MatrixXd& columns, TieSet& out)
{
    const PartPoints points = sample_parts(columns, set.triangles, out.parts, point_spacing * set.diagonal);
    out.tree = connect_parts(out.parts, find_possible_parents(set, out.parts, columns), points, set.masses);
    PartAttacher attacher(set, points, out);
    for (const std::size_t part : out.tree.order) attacher.attach(part);
}

} // namespace pliant
