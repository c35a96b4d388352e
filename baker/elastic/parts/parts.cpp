#include "elastic/parts/parts.h"

#include "base/common/union_find.h"

#include <algorithm>

namespace pliant {

namespace {

UnionFind join_faces(const NormalizedPoses& set)
{
    UnionFind faces(set.triangles.size());
    for (const Hinge& hinge : find_hinges(set.triangles, set.shapes[0])) faces.join(hinge.faces[0], hinge.faces[1]);
    return faces;
}

// Numbers the parts with faces in the order of their lowest face and collects their vertices.
void add_surfaces(const std::vector<Triangle>& triangles, UnionFind faces, Parts& parts)
{
    parts.of_face.resize(triangles.size());
    std::vector<std::size_t> part_of(triangles.size(), no_part); // at the face that represents its set
    for (std::uint32_t f = 0; f < triangles.size(); ++f) {
        std::size_t& part = part_of[faces.find(f)];
        if (part == no_part) {
            part = parts.vertices.size();
            parts.vertices.emplace_back();
        }
        parts.of_face[f] = std::uint32_t(part);
        parts.vertices[part].insert(parts.vertices[part].end(), triangles[f].begin(), triangles[f].end());
    }
    for (std::vector<std::uint32_t>& vertices : parts.vertices) {
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    }
    parts.surface_count = parts.vertices.size();
}

void add_single_vertices(const NormalizedPoses& set, Parts& parts)
{
    std::vector<bool> has_face(std::size_t(set.dof_count() / 3), false);
    for (const Triangle& triangle : set.triangles)
        for (const std::uint32_t v : triangle) has_face[v] = true;
    for (std::uint32_t v = 0; v < has_face.size(); ++v)
        if (!has_face[v]) parts.vertices.push_back({ v });
}

} // namespace

Parts find_parts(const NormalizedPoses& set)
{
    Parts parts;
    add_surfaces(set.triangles, join_faces(set), parts);
    add_single_vertices(set, parts);
    return parts;
}

} // namespace pliant
