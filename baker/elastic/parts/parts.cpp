#include "elastic/parts/parts.h"

#include "base/common/union_find.h"

#include <algorithm>

namespace pliant {

Parts find_parts(const ShapeSet& set)
{
    const std::vector<Triangle>& triangles = set.triangles;
    const std::size_t vertex_count = std::size_t(set.dof_count() / 3);
    UnionFind faces(triangles.size());
    for (const Hinge& hinge : find_hinges(triangles, set.shapes[0])) faces.join(hinge.faces[0], hinge.faces[1]);
    Parts parts;
    parts.of_face.resize(triangles.size());
    std::vector<std::size_t> part_of(triangles.size(), no_part); // at the face that stands for its set
    std::vector<bool> is_used(vertex_count, false);
    for (std::uint32_t f = 0; f < triangles.size(); ++f) {
        std::size_t& part = part_of[faces.find(f)];
        if (part == no_part) {
            part = parts.vertices.size();
            parts.vertices.emplace_back();
        }
        parts.of_face[f] = std::uint32_t(part);
        for (const std::uint32_t v : triangles[f]) {
            parts.vertices[part].push_back(v);
            is_used[v] = true;
        }
    }
    for (std::vector<std::uint32_t>& vertices : parts.vertices) {
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    }
    parts.surface_count = parts.vertices.size();
    for (std::uint32_t v = 0; v < vertex_count; ++v)
        if (!is_used[v]) parts.vertices.push_back({ v });
    return parts;
}

} // namespace pliant
