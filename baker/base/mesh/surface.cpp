#include "base/mesh/surface.h"

#include "base/common/diagnostics.h"
#include "base/common/union_find.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <tuple>

namespace pliant {

namespace {

// A directed edge of a face; sorting by the undirected key brings the two sides of an edge together.
struct Side {
    std::uint64_t key;
    std::uint32_t face, corner;
};

std::uint64_t undirected_key(std::uint32_t a, std::uint32_t b)
{
    return (std::uint64_t(std::min(a, b)) << 32) | std::max(a, b);
}

std::vector<Side> sorted_sides(const std::vector<Triangle>& triangles)
{
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::uint32_t f = 0; f < triangles.size(); ++f)
        for (std::uint32_t c = 0; c < 3; ++c)
            sides.push_back({ undirected_key(triangles[f][c], triangles[f][(c + 1) % 3]), f, c });
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.key, a.face, a.corner) < std::tie(b.key, b.face, b.corner);
    });
    return sides;
}

// Calls visit(begin, end) for the sides of every edge.
template <class Visit> void for_each_edge(const std::vector<Side>& sides, Visit visit)
{
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
        while (end < sides.size() && sides[end].key == sides[begin].key) ++end;
        visit(sides.data() + begin, sides.data() + end);
    }
}

// The sides of one edge in the order in which their faces follow each other around it, from the first one on.
void sort_around(const std::vector<Triangle>& triangles, const Shape& rest, Side* begin, Side* end)
{
    const auto corner
        = [&](const Side& side, std::uint32_t i) { return point(rest, triangles[side.face][(side.corner + i) % 3]); };
    const Eigen::Vector3d origin = corner(*begin, 0), axis = (corner(*begin, 1) - origin).normalized();
    const auto across = [&](const Side& side) -> Eigen::Vector3d {
        const Eigen::Vector3d to = corner(side, 2) - origin;
        return to - to.dot(axis) * axis;
    };
    const Eigen::Vector3d zero = across(*begin), quarter = axis.cross(zero);
    std::vector<std::pair<double, Side>> angles;
    for (const Side* side = begin; side != end; ++side) {
        const double angle = side == begin ? 0 : std::atan2(across(*side).dot(quarter), across(*side).dot(zero));
        angles.push_back({ angle < 0 ? angle + 6.283185307179586 : angle, *side });
    }
    std::stable_sort(angles.begin(), angles.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < angles.size(); ++i) begin[i] = angles[i].second;
}

// Hinges at the edges of at least so many faces.
std::vector<Hinge> pair_faces(const std::vector<Triangle>& triangles, const Shape& rest, std::ptrdiff_t least_face_count)
{
    const std::vector<Side> sides = sorted_sides(triangles);
    std::vector<std::pair<Side, Side>> pairs;
    const auto pair_up = [&](const Side& a, const Side& b) {
        pairs.push_back(a.face < b.face ? std::make_pair(a, b) : std::make_pair(b, a));
    };
    for_each_edge(sides, [&](const Side* begin, const Side* end) {
        if (end - begin < least_face_count) return;
        if (end - begin == 2) return pair_up(begin[0], begin[1]);
        std::vector<Side> around(begin, end);
        sort_around(triangles, rest, around.data(), around.data() + around.size());
        for (std::size_t i = 0; i < around.size(); ++i) pair_up(around[i], around[(i + 1) % around.size()]);
    });
    std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
        return std::tie(a.first.face, a.first.corner, a.second.face) < std::tie(b.first.face, b.first.corner, b.second.face);
    });

    std::vector<Hinge> hinges;
    hinges.reserve(pairs.size());
    for (const auto& [one, two] : pairs) {
        const Triangle& f = triangles[one.face];
        const Triangle& g = triangles[two.face];
        hinges.push_back({ { f[one.corner], f[(one.corner + 1) % 3], f[(one.corner + 2) % 3], g[(two.corner + 2) % 3] },
                           { one.face, two.face } });
    }
    return hinges;
}

} // namespace

std::vector<Hinge> find_hinges(const std::vector<Triangle>& triangles, const Shape& rest)
{
    return pair_faces(triangles, rest, 2);
}

std::vector<Hinge> find_crowded_hinges(const std::vector<Triangle>& triangles, const Shape& rest)
{
    return pair_faces(triangles, rest, 3);
}

void require_manifold(const std::vector<Triangle>& triangles, std::size_t vertex_count,
                      const std::vector<std::uint32_t>& sources, const std::string& what, const std::string& remedy)
{
    const auto number = [&](std::size_t v) { return sources.empty() ? v : std::size_t(sources[v]); };
    std::string defect;
    UnionFind parts(triangles.size());
    std::vector<bool> is_used(vertex_count, false);
    for_each_edge(sorted_sides(triangles), [&](const Side* begin, const Side* end) {
        const std::uint32_t from = triangles[begin->face][begin->corner],
                            to = triangles[begin->face][(begin->corner + 1) % 3];
        is_used[from] = is_used[to] = true;
        for (const Side* side = begin + 1; side < end; ++side) parts.join(begin->face, side->face);
        if (!defect.empty() || end - begin < 2) return;
        if (end - begin > 2)
            defect = fmt::format("edge {} {} belongs to {} faces", number(from), number(to), end - begin);
        else if (triangles[begin[1].face][begin[1].corner] == from)
            defect = fmt::format("the faces at edge {} {} have opposite orientations", number(from), number(to));
    });
    for (std::uint32_t f = 1; f < triangles.size() && defect.empty(); ++f)
        if (parts.find(f) != parts.find(0)) defect = "it has several components";
    const auto unused = std::find(is_used.begin(), is_used.end(), false);
    if (defect.empty() && unused != is_used.end())
        defect = fmt::format("vertex {} belongs to no face", number(std::size_t(unused - is_used.begin())));
    if (!defect.empty())
        throw Failure(ExitCode::bad_input,
                      error_at(2222, "", fmt::format("{} needs one oriented manifold surface: {}", what, defect), remedy));
}

Eigen::Vector3d double_area_vector(const Shape& shape, const Triangle& triangle)
{
    const Eigen::Vector3d origin = point(shape, triangle[0]);
    return (point(shape, triangle[1]) - origin).cross(point(shape, triangle[2]) - origin);
}

Eigen::VectorXd triangle_areas(const Shape& shape, const std::vector<Triangle>& triangles)
{
    Eigen::VectorXd areas(triangles.size());
    for (std::size_t f = 0; f < triangles.size(); ++f) areas[f] = 0.5 * double_area_vector(shape, triangles[f]).norm();
    return areas;
}

Eigen::VectorXd lumped_masses(const Shape& shape, const std::vector<Triangle>& triangles)
{
    Eigen::VectorXd masses = Eigen::VectorXd::Zero(shape.size() / 3);
    for (const Triangle& t : triangles) {
        const double third = double_area_vector(shape, t).norm() / 6;
        for (std::uint32_t v : t) masses[v] += third;
    }
    return masses;
}

double box_diagonal(const Positions& positions)
{
    return (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).norm();
}

} // namespace pliant
