// Points that ride on a solid: each is a fixed combination of the corners of one tetrahedron.
#pragma once

#include "base/mesh/pose_set.h"

namespace pliant {

struct Embedding {
    std::vector<Tetrahedron> corners;                 // per point: the vertices of the solid that it hangs on
    Eigen::Matrix<double, 4, Eigen::Dynamic> weights; // per point, for these corners: sum 1, within [0, 1] inside the solid
    Eigen::VectorXd distances; // per point, from the solid, in units of the positions: 0 inside, infinity beyond the reach

    std::size_t count() const { return corners.size(); }
};

// Barycentric coordinates of every point in the tetrahedron that contains it. A point outside takes the nearest tetrahedron,
// of several equally near the one with the smallest coordinates, and coordinates that go on beyond it; one farther than
// `reach` has zero weights. Coordinates below 1e-12 are rounding and zero. The tetrahedra must have volume. Cost: a tree of
// boxes, logarithmic per point.
Embedding embed(const Positions& points, const Positions& vertices, const std::vector<Tetrahedron>& tets, double reach);

// The points where the embedding takes them: `columns` are shapes of the solid, or directions (3 x vertices rows).
Eigen::MatrixXd apply(const Embedding& embedding, const Eigen::Ref<const Eigen::MatrixXd>& columns);

} // namespace pliant
