#include "elastic/parts/seams.h"

#include "base/mesh/point_tree.h"
#include "elastic/parts/anchors.h"

#include <algorithm>

namespace pliant {

namespace {

// In units of the edge's length in each pose: a border vertex lies on an edge if it is this near to it, and inside the edge
// if its foot is this far from both ends.
constexpr double seam_width = 0.05;

class SeamFinder {
public:
    SeamFinder(const NormalizedPoses& set, const Eigen::MatrixXd& columns, const std::vector<BorderEdge>& border)
        : set_(set)
        , columns_(columns)
        , border_(border)
        , found_(std::size_t(columns.cols()))
    {
        for (const BorderEdge& edge : border_) {
            neighbours_.emplace_back(edge.a, edge.b);
            neighbours_.emplace_back(edge.b, edge.a);
        }
        std::sort(neighbours_.begin(), neighbours_.end());
    }

    std::vector<std::array<std::uint32_t, 4>> find()
    {
        const std::vector<TreePoint> points = border_vertices();
        const PointTree tree(columns_, points);
        for (const BorderEdge& edge : border_) {
            const Eigen::VectorXd along = columns_.col(edge.b) - columns_.col(edge.a);
            const Eigen::VectorXd middle = columns_.col(edge.a) + 0.5 * along;
            for (const std::uint32_t v : tree.ball(middle, (0.5 + seam_width) * along.norm(), 0)) consider(v, edge, along);
        }
        std::vector<std::array<std::uint32_t, 4>> out;
        for (const TreePoint& point : points)
            if (const BorderEdge* edge = found_[point.vertex].edge)
                out.push_back({ point.vertex, edge->a, edge->b, edge->c });
        return out;
    }

private:
    struct Nearest {
        double squared_distance = infinity;
        const BorderEdge* edge = nullptr;
    };

    std::vector<TreePoint> border_vertices() const
    {
        std::vector<TreePoint> out;
        for (std::size_t i = 0; i < neighbours_.size(); ++i)
            if (i == 0 || neighbours_[i].first != neighbours_[i - 1].first) out.push_back({ neighbours_[i].first, 0 });
        return out;
    }

    // Keeps the edge if v lies on it and on none that is nearer.
    void consider(std::uint32_t v, const BorderEdge& edge, const Eigen::VectorXd& along)
    {
        if (v == edge.a || v == edge.b || v == edge.c) return;
        const double length2 = along.squaredNorm();
        const Eigen::VectorXd off = columns_.col(v) - columns_.col(edge.a);
        const double foot = std::clamp(off.dot(along) / length2, 0.0, 1.0);
        const double distance2 = (off - foot * along).squaredNorm();
        if (distance2 > seam_width * seam_width * length2 || distance2 >= found_[v].squared_distance) return;
        if (!is_closed(v, edge, foot) || is_round_corner(v, edge, foot)) return;
        if (measure_triangle(set_, edge.a, edge.b, edge.c).quality < poor_triangle) return;
        found_[v] = { distance2, &edge };
    }

    // Tests every pose: lips and eyelids that open in one of many poses are near in the mean of all.
    bool is_closed(std::uint32_t v, const BorderEdge& edge, double foot) const
    {
        return std::all_of(set_.shapes.begin(), set_.shapes.end(), [&](const Shape& shape) {
            const Eigen::Vector3d a = point(shape, edge.a), along = point(shape, edge.b) - a;
            return (point(shape, v) - a - foot * along).norm() <= seam_width * along.norm();
        });
    }

    // Where a border turns a corner, a vertex is near the end of the next edge of the same border. That is no seam.
    bool is_round_corner(std::uint32_t v, const BorderEdge& edge, double foot) const
    {
        const std::uint32_t end = foot < seam_width ? edge.a : edge.b;
        const bool is_inside = foot >= seam_width && foot <= 1 - seam_width;
        return !is_inside && std::binary_search(neighbours_.begin(), neighbours_.end(), std::make_pair(v, end));
    }

    const NormalizedPoses& set_;
    const Eigen::MatrixXd& columns_;
    const std::vector<BorderEdge>& border_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours_; // along border edges, in both directions, sorted
    std::vector<Nearest> found_;                                      // per vertex
};

} // namespace

std::vector<BorderEdge> find_border(const NormalizedPoses& set)
{
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    std::vector<Edge> inner;
    for (const Hinge& hinge : find_hinges(set.triangles, set.shapes[0]))
        inner.push_back(std::minmax(hinge.vertices[0], hinge.vertices[1]));
    std::sort(inner.begin(), inner.end());
    std::vector<BorderEdge> border;
    for (const Triangle& t : set.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const BorderEdge edge = { t[i], t[(i + 1) % 3], t[(i + 2) % 3] };
            if (!std::binary_search(inner.begin(), inner.end(), Edge(std::minmax(edge.a, edge.b)))) border.push_back(edge);
        }
    return border;
}

std::vector<std::array<std::uint32_t, 4>> find_seams(const NormalizedPoses& set, const Eigen::MatrixXd& columns,
                                                     const std::vector<BorderEdge>& border)
{
    return SeamFinder(set, columns, border).find();
}

} // namespace pliant
