// Measures of tetrahedra, and what surfaces and solids have in common.
#pragma once

#include "base/mesh/normalized_poses.h"

namespace pliant {

// Edge vectors b - a, c - a, d - a as columns.
Eigen::Matrix3d tet_edges(const Shape& shape, const Tetrahedron& tet);

// Signed volume of every tetrahedron.
Eigen::VectorXd tet_volumes(const Shape& shape, const std::vector<Tetrahedron>& tets);

// Lumped mass per vertex: a quarter of the volume of the tetrahedra around it (n).
Eigen::VectorXd lumped_tet_masses(const Shape& shape, const std::vector<Tetrahedron>& tets);

// Mass of a vertex that no triangle has, over the mean mass: enough to keep the mass matrix definite and its entries of one
// scale, and so little that all the loose vertices of a file together move neither alignment nor errors by more than a
// thousandth.
constexpr double lone_vertex_mass = 1e-3;

// Lumped masses of one shape of the set, whatever its cells; all positive.
Eigen::VectorXd cell_masses(const NormalizedPoses& set, const Shape& shape);

// Sizes of the cells of a set's mesh: signed volumes of a solid, areas of a surface. Where they vanish a shape is
// degenerate.
Eigen::VectorXd cell_sizes(const NormalizedPoses& set, const Shape& shape);

} // namespace pliant
