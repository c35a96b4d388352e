// In which order the parts of a surface hang on one another.
#pragma once

#include "elastic/parts/part_points.h"

namespace pliant {

// A tree over the parts: each hangs on one that can hold others, and those hang together so that the sum of the distances is the least
// (distances of pose_space, between the vertices of one and the surface of the other). The root, of those the part of the largest mass, hangs on none.
struct PartTree {
    std::vector<std::size_t> parents; // per part; no_part: the root
    std::vector<std::size_t> order;   // of parts: parents before what hangs on them
};

// Per part, whether another may hang on it; only parts with faces can, and one does. Costs n log n for each of at most log2(parts)
// rounds (Boruvka 1926).
PartTree connect_parts(const Parts& parts, const std::vector<bool>& can_be_parent, const PartPoints& points,
                       const Eigen::VectorXd& masses);

} // namespace pliant
