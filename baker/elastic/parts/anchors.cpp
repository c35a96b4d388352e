#include "elastic/parts/anchors.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// In units of the diagonal: anchors lie about so far apart.
constexpr double anchor_spread = 0.05;

// Of a part's vertices some that lie far apart: the first, and always the one farthest from those before.
std::vector<std::uint32_t> spread_vertices(const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns,
                                           std::size_t most)
{
    std::vector<std::uint32_t> out = { vertices[0] };
    std::vector<double> gaps(vertices.size(), infinity);
    while (out.size() < most) {
        for (std::size_t i = 0; i < gaps.size(); ++i)
            gaps[i] = std::min(gaps[i], (columns.col(vertices[i]) - columns.col(out.back())).squaredNorm());
        const auto next = std::max_element(gaps.begin(), gaps.end());
        if (!(*next > 0)) break;
        out.push_back(vertices[std::size_t(next - gaps.begin())]);
    }
    return out;
}

} // namespace

TriangleMeasure measure_triangle(const ShapeSet& set, std::uint32_t a, std::uint32_t b, std::uint32_t c)
{
    TriangleMeasure out = { infinity, infinity };
    for (const Shape& shape : set.shapes) {
        const Eigen::Vector3d ab = point(shape, b) - point(shape, a), ac = point(shape, c) - point(shape, a);
        const double twice_area = ab.cross(ac).norm();
        const double longest = std::max({ ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm() });
        out.area = std::min(out.area, 0.5 * twice_area);
        out.quality = std::min(out.quality, longest > 0 ? 2 * twice_area / longest : 0);
    }
    return out;
}

bool can_anchor(const ShapeSet& set, const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns,
                double quality)
{
    constexpr std::size_t most = 10; // of a line all triangles are poor, of anything else few among so many are
    const std::vector<std::uint32_t> points = spread_vertices(vertices, columns, most);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j)
            for (std::size_t k = j + 1; k < points.size(); ++k)
                if (measure_triangle(set, points[i], points[j], points[k]).quality >= quality) return true;
    return false;
}

std::optional<Tie> tie_vertex(const ShapeSet& set, const Eigen::MatrixXd& columns, std::size_t part, std::uint32_t v,
                              const PartTrees& parent)
{
    const Neighbour nearest = parent.vertices.nearest(v, 1, infinity);
    const std::uint32_t a = parent.vertices.points()[nearest.point].vertex;
    const double wanted = std::max(anchor_spread * set.diagonal, 1.5 * std::sqrt(nearest.squared_distance));
    double best_quality = 0;
    std::array<std::uint32_t, 4> best = { v, a, a, a };
    // Of a parent that is smaller than the ball, half of it comes first: the ball sees no more than a few points at each distance.
    for (double reach = std::min(wanted, parent.size / 2); best_quality < good_triangle; reach *= 2) {
        const std::vector<std::uint32_t> around = parent.vertices.ball(columns.col(a), reach, reach / 4);
        double best_worth = 0;
        for (std::size_t i = 0; i < around.size(); ++i)
            for (std::size_t j = i + 1; j < around.size(); ++j) {
                if (around[i] == v || around[j] == v || around[i] == a || around[j] == a) continue;
                const std::array<std::uint32_t, 4> vertices = { v, a, around[i], around[j] };
                const TriangleMeasure found = measure_triangle(set, a, around[i], around[j]);
                const bool is_good = found.quality >= good_triangle;
                if (!is_good && (best_worth > 0 || found.quality <= best_quality)) continue;
                if (is_good) {
                    if (found.area * max_stiffness <= best_worth) continue; // the most that it may be worth
                    const double worth = found.area * make_tie(set, part, vertices).stiffness;
                    if (worth <= best_worth) continue;
                    best_worth = worth;
                }
                best_quality = found.quality;
                best = vertices;
            }
        if (reach >= parent.size) break; // that was all of it
    }
    if (best_quality < poor_triangle) return {};
    return make_tie(set, part, best);
}

} // namespace pliant
