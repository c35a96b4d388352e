// The boundary of a solid, and the numbering in which the baker works on it.
#pragma once

#include "base/mesh/pose_set.h"

namespace pliant {

// The corners of the four faces of a tetrahedron, each counter-clockwise seen from outside if the volume is positive. Face i
// lies opposite to corner i.
constexpr std::array<std::array<std::size_t, 3>, 4> tet_faces { { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } } };

// One face of one tetrahedron.
struct TetFace {
    Triangle sorted; // its vertices, ascending
    std::uint32_t tet;
    std::uint32_t face : 2;
    bool is_even; // whether `sorted` is the face itself or the face seen from the other side

    bool same_vertices(const TetFace& other) const { return sorted == other.sorted; }
};

// All faces, four a tetrahedron, those with the same vertices behind each other. Tetrahedra marked in `left_out` (which may
// be empty) have none.
std::vector<TetFace> collect_faces(const std::vector<Tetrahedron>& tets, const std::vector<bool>& left_out = {});

// Faces that belong to one tetrahedron only, outward, in the order of the tetrahedra.
std::vector<Triangle> boundary_of(const std::vector<Tetrahedron>& tets);

// The vertices of a solid, those of its boundary first, each part in the order of the file.
struct SolidNumbering {
    std::vector<std::uint32_t> sources; // per new number the one in the file
    std::vector<std::uint32_t> places;  // and back
    std::size_t boundary_count = 0;
};
SolidNumbering number_boundary_first(const std::vector<Triangle>& boundary, std::size_t vertex_count);

// Triangles as faces.
Polygons to_polygons(const std::vector<Triangle>& triangles);

} // namespace pliant
