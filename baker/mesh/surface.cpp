#include "mesh/surface.h"

#include "report/diagnostics.h"

#include <algorithm>
#include <fmt/core.h>
#include <map>

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

} // namespace

std::vector<Hinge> find_hinges(const std::vector<Triangle>& triangles)
{
    const std::vector<Side> sides = sorted_sides(triangles);
    std::vector<std::pair<Side, Side>> pairs;
    for (std::size_t i = 0; i + 1 < sides.size(); ++i)
        if (sides[i].key == sides[i + 1].key) pairs.push_back({ sides[i], sides[i + 1] });
    std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
        return std::tie(a.first.face, a.first.corner) < std::tie(b.first.face, b.first.corner);
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

std::vector<Fan> find_fans(const std::vector<Triangle>& triangles, std::size_t vertex_count)
{
    // next[v] maps a neighbour of v to the one that follows it counter-clockwise.
    std::vector<std::map<std::uint32_t, std::uint32_t>> next(vertex_count);
    std::vector<std::map<std::uint32_t, std::uint32_t>> previous(vertex_count);
    for (const Triangle& t : triangles)
        for (int c = 0; c < 3; ++c) {
            next[t[c]][t[(c + 1) % 3]] = t[(c + 2) % 3];
            previous[t[c]][t[(c + 2) % 3]] = t[(c + 1) % 3];
        }

    std::vector<Fan> fans(vertex_count);
    for (std::size_t v = 0; v < vertex_count; ++v) {
        if (next[v].empty()) continue;
        Fan& fan = fans[v];
        std::uint32_t start = next[v].begin()->first;
        fan.is_closed = true;
        for (const auto& [neighbour, follower] : next[v])
            if (!previous[v].count(neighbour)) {
                start = neighbour;
                fan.is_closed = false;
            }
        fan.ring.push_back(start);
        for (auto it = next[v].find(start); it != next[v].end() && it->second != start; it = next[v].find(it->second))
            fan.ring.push_back(it->second);
        const std::size_t faces_in_fan = fan.is_closed ? fan.ring.size() : fan.ring.size() - 1;
        if (faces_in_fan != next[v].size())
            throw Failure(ExitCode::bad_input,
                          error_at(4502, "",
                                   fmt::format("the faces at vertex {} form more than one fan (a bow-tie vertex)", v),
                                   "split the vertex in the modelling program, or use --material discrete-shells"));
    }
    return fans;
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

} // namespace pliant
