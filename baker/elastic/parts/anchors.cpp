#include "elastic/parts/anchors.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

// Least search radius around the first anchor, in units of the diagonal. Smaller triangles rotate with every wrinkle of the
// surface.
constexpr double anchor_spread = 0.05;

// Farthest-point sampling: starts with the first vertex and adds the one farthest from those chosen before.
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

// Finds the best anchors of one vertex in balls around the nearest vertex of the other part.
class AnchorSearch {
public:
    AnchorSearch(const NormalizedPoses& set, std::size_t part, std::uint32_t vertex, std::uint32_t nearest)
        : set_(set)
        , part_(part)
        , best_({ vertex, nearest, nearest, nearest })
    {
    }

    double quality() const { return quality_; }
    const std::array<std::uint32_t, 4>& best() const { return best_; }

    void try_pairs(const std::vector<std::uint32_t>& around)
    {
        worth_ = 0;
        for (std::size_t i = 0; i < around.size(); ++i)
            for (std::size_t j = i + 1; j < around.size(); ++j)
                if (is_free(around[i]) && is_free(around[j])) try_pair(around[i], around[j]);
    }

private:
    bool is_free(std::uint32_t v) const { return v != best_[0] && v != best_[1]; }

    // Good triangles compete by worth, area times stiffness; while there is none, others compete by quality.
    void try_pair(std::uint32_t b, std::uint32_t c)
    {
        const std::array<std::uint32_t, 4> vertices = { best_[0], best_[1], b, c };
        const TriangleMeasure found = measure_triangle(set_, best_[1], b, c);
        if (found.quality >= good_triangle) {
            if (found.area * max_stiffness <= worth_) return; // an upper bound that is cheaper than the tie
            const double worth = found.area * make_tie(set_, part_, vertices).stiffness;
            if (worth <= worth_) return;
            worth_ = worth;
        } else if (worth_ > 0 || found.quality <= quality_)
            return;
        quality_ = found.quality;
        best_ = vertices;
    }

    const NormalizedPoses& set_;
    std::size_t part_;
    std::array<std::uint32_t, 4> best_;
    double quality_ = 0, worth_ = 0;
};

} // namespace

TriangleMeasure measure_triangle(const NormalizedPoses& set, std::uint32_t a, std::uint32_t b, std::uint32_t c)
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

bool can_anchor(const NormalizedPoses& set, const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns,
                double quality)
{
    constexpr std::size_t most = 10; // all triangles of a line are poor; of other sets, few among so many vertices are
    const std::vector<std::uint32_t> points = spread_vertices(vertices, columns, most);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j)
            for (std::size_t k = j + 1; k < points.size(); ++k)
                if (measure_triangle(set, points[i], points[j], points[k]).quality >= quality) return true;
    return false;
}

std::optional<Tie> tie_vertex(const NormalizedPoses& set, const Eigen::MatrixXd& columns, std::size_t part, std::uint32_t v,
                              const PartTrees& other)
{
    const Neighbour nearest = other.vertices.nearest(v, 1, infinity);
    const std::uint32_t a = other.vertices.points()[nearest.point].vertex;
    const double wanted = std::max(anchor_spread * set.diagonal, 1.5 * std::sqrt(nearest.squared_distance));
    AnchorSearch search(set, part, v, a);
    // ball() returns few points per distance, so that a ball around the whole part would see little of it: start with half
    // its size.
    for (double reach = std::min(wanted, other.size / 2); search.quality() < good_triangle; reach *= 2) {
        search.try_pairs(other.vertices.ball(columns.col(a), reach, reach / 4));
        if (reach >= other.size) break; // the ball contained the whole part
    }
    if (search.quality() < poor_triangle) return {};
    return make_tie(set, part, search.best());
}

} // namespace pliant
