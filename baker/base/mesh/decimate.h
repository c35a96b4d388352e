// A coarse mesh with the poses of a fine one.
#pragma once

#include "base/mesh/normalized_poses.h"

#include <vector>

namespace pliant {

struct CoarsePoses {
    NormalizedPoses set;                 // in the units of the full set; free
    std::vector<std::uint32_t> vertices; // which vertices of the full mesh are left
};

// Decimates pose 0 to about `vertex_count` vertices by quadrics (OpenMesh). Half-edge collapse keeps a subset of the
// vertices, so every pose comes over by taking their rows. Needs one oriented manifold surface (manifold_defect). Throws
// Failure (bad_input, P4503). Cost: below a second for 20,000 vertices.
CoarsePoses decimate(const NormalizedPoses& set, std::size_t vertex_count);

} // namespace pliant
