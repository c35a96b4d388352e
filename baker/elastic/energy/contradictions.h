// Layers whose sum is no rest state that a surface could have.
#pragma once

#include "base/mesh/normalized_poses.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

// Two layers that contradict each other at full strength of both, where neither does alone: in more than 2 % of the edges,
// or of the faces, that both change.
struct Contradiction {
    std::size_t first, second;            // poses
    std::size_t folded_edge_count = 0;    // whose rest angle lies beyond half a turn: one face would pass through the other
    std::size_t stretched_face_count = 0; // whose rest metric is stretched, or squeezed, more than tenfold
    std::uint32_t vertex = 0;             // of one of them
};

// All such pairs, the worst first; of a surface only. Cost: edges and faces times pairs of layers.
std::vector<Contradiction> find_contradictions(const NormalizedPoses& set);

} // namespace pliant
