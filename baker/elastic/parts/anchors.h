// Which three vertices of a part hold a vertex of another.
#pragma once

#include "base/mesh/point_tree.h"
#include "elastic/parts/tie_set.h"

#include <optional>

namespace pliant {

// Anchors a b c should have at least this ratio of 4 area / (longest side)^2 in every pose; 1.7 is equilateral, below the ratio places
// are ill-defined.
constexpr double good_triangle = 0.2, poor_triangle = 1e-3;

// The smallest over the poses of the area of a triangle, and of its ratio to the longest side.
struct TriangleMeasure {
    double area, quality;
};

TriangleMeasure measure_triangle(const ShapeSet& set, std::uint32_t a, std::uint32_t b, std::uint32_t c);

// The points of a part to look among.
struct PartTrees {
    PointTree surface, vertices;
    double size; // diagonal of the box of its vertices in pose space
};

// Whether places can be told from some of these vertices: three are a triangle of this quality in every pose.
bool can_anchor(const ShapeSet& set, const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns,
                double quality);

// Anchors: the nearest vertex of the parent, and two around it that make a large triangle in every pose, among which the vertex keeps its
// place. The farther the vertex, the larger, so that a small turn of the triangle is not a large way of the vertex.
std::optional<Tie> tie_vertex(const ShapeSet& set, const Eigen::MatrixXd& columns, std::size_t part, std::uint32_t v,
                              const PartTrees& parent);

} // namespace pliant
