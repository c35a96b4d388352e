// Seams: borders that lie on other borders (T-junctions, cracks). Ties keep them closed.
#pragma once

#include "base/mesh/normalized_poses.h"

namespace pliant {

// An edge a b with one triangle only, and the triangle's third corner c.
struct BorderEdge {
    std::uint32_t a, b, c;
};

std::vector<BorderEdge> find_border(const NormalizedPoses& set);

// The border vertices that lie on another border edge in every pose, in ascending order, each with the corners a, b, c of
// the triangle at that edge. `columns`: the set in pose space (3m x n). Cost: n log n.
std::vector<std::array<std::uint32_t, 4>> find_seams(const NormalizedPoses& set, const Eigen::MatrixXd& columns,
                                                     const std::vector<BorderEdge>& border);

} // namespace pliant
