// Anchors: the three vertices of a part to which a vertex of another part is tied.
#pragma once

#include "base/mesh/point_tree.h"
#include "elastic/parts/tie_set.h"

#include <optional>

namespace pliant {

// Quality of a triangle: 4 area / (longest side)^2, sqrt(3) if it is equilateral. Anchors of good quality are preferred;
// below the poor one the place is ill-defined and no tie is made.
constexpr double good_triangle = 0.2, poor_triangle = 1e-3;

// The smallest area (normalized, squared length) and the smallest quality over the poses.
struct TriangleMeasure {
    double area, quality;
};

TriangleMeasure measure_triangle(const NormalizedPoses& set, std::uint32_t a, std::uint32_t b, std::uint32_t c);

// Search structures of one part, in pose space.
struct PartTrees {
    PointTree surface, vertices; // of its vertices and sample points, and of its vertices only
    double size;                 // diagonal of the bounding box of its vertices
};

// Whether some three of these vertices have at least this quality in every pose. Looks at 10 vertices spread over them, so
// that it can miss a few sets that are nearly a line. Cost: linear in the number of vertices.
bool can_anchor(const NormalizedPoses& set, const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns,
                double quality);

// Ties vertex `v` of `part` to three vertices of another part: the nearest one, and two around it with the largest product
// of area and stiffness. The search radius grows with the distance of v, so that a small rotation of the triangle does not
// move v far. Empty if there is no usable triangle. `columns`: pose space. Cost: some 60^2 / 2 triangles per radius tried.
std::optional<Tie> tie_vertex(const NormalizedPoses& set, const Eigen::MatrixXd& columns, std::size_t part, std::uint32_t v,
                              const PartTrees& other);

} // namespace pliant
