// Connectivity and measures of a triangle surface, shared by all poses.
#pragma once

#include "base/mesh/pose_set.h"

namespace pliant {

// Positions of one shape as the solvers see them: x y z of vertex 0, x y z of vertex 1, ... (3n).
using Shape = Eigen::VectorXd;

inline Eigen::Vector3d point(const Shape& shape, std::uint32_t vertex) { return shape.segment<3>(3 * Eigen::Index(vertex)); }

// cross_matrix(v) * x = v x x.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v)
{
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

// An edge with two of its faces. `first` and `second` run along the edge as the face of lower index has it; `left` is
// opposite in that face, `right` in the other, whichever way round that one goes. Vertex order x0 x1 x2 x3 of the energies:
// first, second, left, right.
struct Hinge {
    std::array<std::uint32_t, 4> vertices; // first, second, left, right
    std::array<std::uint32_t, 2> faces;
};

// One hinge for every edge of two faces, and at an edge of three or more one for each pair that follow each other around it
// in `rest` (as many as faces). Ordered by the first face and the corner in it. No two triangles may have the same vertices.
std::vector<Hinge> find_hinges(const std::vector<Triangle>& triangles, const Shape& rest);

// Those of them at edges of three or more faces.
std::vector<Hinge> find_crowded_hinges(const std::vector<Triangle>& triangles, const Shape& rest);

// Throws Failure (bad_input, P2222) naming `what` needs it if the triangles are no connected oriented manifold that uses
// every vertex.
// `sources`: per vertex its number for the message; empty: the same.
void require_manifold(const std::vector<Triangle>& triangles, std::size_t vertex_count,
                      const std::vector<std::uint32_t>& sources, const std::string& what, const std::string& remedy);

// Twice the area vector (face normal times twice the area) of a triangle.
Eigen::Vector3d double_area_vector(const Shape& shape, const Triangle& triangle);

// Area of every triangle.
Eigen::VectorXd triangle_areas(const Shape& shape, const std::vector<Triangle>& triangles);

// Diagonal of the bounding box.
double box_diagonal(const Positions& positions);

// Lumped mass per vertex: a third of the area of the triangles around it (n).
Eigen::VectorXd lumped_masses(const Shape& shape, const std::vector<Triangle>& triangles);

} // namespace pliant
