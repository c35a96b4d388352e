#include "base/mesh/solid.h"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {

// Sorts; true if that took an even number of exchanges, so that the triangle is seen from the same side as before.
bool sort_corners(Triangle& v)
{
    bool is_even = true;
    const auto order = [&](std::size_t a, std::size_t b) {
        if (v[a] <= v[b]) return;
        std::swap(v[a], v[b]);
        is_even = !is_even;
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    return is_even;
}

} // namespace

std::vector<TetFace> collect_faces(const std::vector<Tetrahedron>& tets, const std::vector<bool>& left_out)
{
    std::vector<TetFace> faces;
    faces.reserve(4 * tets.size());
    for (std::uint32_t t = 0; t < tets.size(); ++t) {
        if (!left_out.empty() && left_out[t]) continue;
        for (std::uint32_t i = 0; i < 4; ++i) {
            Triangle v { tets[t][tet_faces[i][0]], tets[t][tet_faces[i][1]], tets[t][tet_faces[i][2]] };
            const bool is_even = sort_corners(v);
            faces.push_back({ v, t, i, is_even });
        }
    }
    std::sort(faces.begin(), faces.end(),
              [](const TetFace& a, const TetFace& b) { return a.sorted != b.sorted ? a.sorted < b.sorted : a.tet < b.tet; });
    return faces;
}

std::vector<Triangle> boundary_of(const std::vector<Tetrahedron>& tets)
{
    const std::vector<TetFace> faces = collect_faces(tets);
    std::vector<bool> is_boundary(4 * tets.size(), false);
    for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
        while (end < faces.size() && faces[end].same_vertices(faces[begin])) ++end;
        if (end - begin == 1) is_boundary[4 * std::size_t(faces[begin].tet) + faces[begin].face] = true;
    }
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < is_boundary.size(); ++i) {
        if (!is_boundary[i]) continue;
        const Tetrahedron& tet = tets[i / 4];
        const auto& corners = tet_faces[i % 4];
        triangles.push_back({ tet[corners[0]], tet[corners[1]], tet[corners[2]] });
    }
    return triangles;
}

SolidNumbering number_boundary_first(const std::vector<Triangle>& boundary, std::size_t vertex_count)
{
    std::vector<bool> is_boundary(vertex_count, false);
    for (const Triangle& triangle : boundary) {
        for (const std::uint32_t vertex : triangle) is_boundary[vertex] = true;
    }
    SolidNumbering numbering;
    numbering.places.resize(vertex_count);
    for (const bool part : { true, false }) {
        for (std::uint32_t vertex = 0; vertex < vertex_count; ++vertex) {
            if (is_boundary[vertex] != part) continue;
            numbering.places[vertex] = static_cast<std::uint32_t>(numbering.sources.size());
            numbering.sources.push_back(vertex);
        }
        if (part) numbering.boundary_count = numbering.sources.size();
    }
    return numbering;
}

Polygons to_polygons(const std::vector<Triangle>& triangles)
{
    Polygons polygons;
    polygons.offsets.reserve(triangles.size() + 1);
    polygons.indices.reserve(3 * triangles.size());
    for (const Triangle& triangle : triangles) {
        polygons.indices.insert(polygons.indices.end(), triangle.begin(), triangle.end());
        polygons.offsets.push_back(static_cast<std::uint32_t>(polygons.indices.size()));
    }
    return polygons;
}

} // namespace pliant
