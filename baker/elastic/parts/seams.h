// Borders that lie on borders: T-junctions and cracks.
#pragma once

#include "base/mesh/shape_set.h"

namespace pliant {

// An edge of one triangle only, and the corner opposite.
struct BorderEdge {
    std::uint32_t a, b, c;
};

std::vector<BorderEdge> find_border(const ShapeSet& set);

// The border vertices that lie on another border, each with the triangle at that border, by ascending vertex.
std::vector<std::array<std::uint32_t, 4>> find_seams(const ShapeSet& set, const Eigen::MatrixXd& columns,
                                                     const std::vector<BorderEdge>& border);

} // namespace pliant
