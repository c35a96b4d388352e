// Connectivity and measures of a triangle surface, shared by all poses.
#pragma once

#include "mesh/pose_set.h"

namespace pliant {

// Positions of one shape as the solvers see them: x y z of vertex 0, x y z of vertex 1, ... (3n).
using Shape = Eigen::VectorXd;

inline Eigen::Vector3d point(const Shape& shape, std::uint32_t vertex) { return shape.segment<3>(3 * Eigen::Index(vertex)); }

// An interior edge with its two faces. `first` and `second` run along the edge as the face of lower index has it; `left` is
// opposite in that face, `right` in the other. Vertex order x0 x1 x2 x3 of the energies: first, second, left, right.
struct Hinge {
    std::array<std::uint32_t, 4> vertices; // first, second, left, right
    std::array<std::uint32_t, 2> faces;
};

// All interior edges, ordered by their first face and the corner in it. The surface must be an oriented manifold.
std::vector<Hinge> find_hinges(const std::vector<Triangle>& triangles);

// Neighbours of a vertex in fan order: faces are (vertex, ring[i], ring[i + 1]); a closed ring also has (vertex, last, first).
struct Fan {
    std::vector<std::uint32_t> ring;
    bool is_closed = false;
};

// One fan per vertex. Throws Failure (P4502) at a vertex whose faces form more than one fan (a bow-tie), since a cell needs one.
std::vector<Fan> find_fans(const std::vector<Triangle>& triangles, std::size_t vertex_count);

// Twice the area vector (face normal times twice the area) of a triangle.
Eigen::Vector3d double_area_vector(const Shape& shape, const Triangle& triangle);

// Area of every triangle.
Eigen::VectorXd triangle_areas(const Shape& shape, const std::vector<Triangle>& triangles);

// Lumped mass per vertex: a third of the area of the triangles around it (n).
Eigen::VectorXd lumped_masses(const Shape& shape, const std::vector<Triangle>& triangles);

} // namespace pliant
