// Coarse meshes of the same poses.
#pragma once

#include "base/mesh/normalized_poses.h"

#include <optional>

namespace pliant {

struct DecimatedPoses {
    NormalizedPoses set;                    // in the units of the full set; of no fixed vertices
    std::vector<std::uint32_t> vertices;    // which vertices of the full set are left
    std::optional<std::size_t> failed_face; // of the full set, without a place among its neighbours: the rest is empty
};

// Decimates the surface of pose 0 to about `vertex_count` vertices by quadrics (OpenMesh). Half-edge collapse keeps a subset
// of the vertices, so every pose comes over by taking its rows. More vertices are left where fewer would make slivers.
DecimatedPoses decimate(const NormalizedPoses& set, std::size_t vertex_count);

} // namespace pliant
