// The parts of a surface, and in which order one hangs on another.
#pragma once

#include "base/mesh/point_tree.h"

namespace pliant {

struct PartPoints;

// A part is all faces that can be reached across hinges, with their vertices; a vertex in which two parts touch belongs to both. A
// vertex without a face is a part of its own.
struct Parts {
    std::vector<std::vector<std::uint32_t>>
        vertices;                       // per part, ascending; in the order of their lowest face, single vertices last
    std::size_t surface_count = 0;      // leading parts with faces
    std::vector<std::uint32_t> of_face; // per face

    std::size_t count() const { return vertices.size(); }
};

Parts find_parts(const ShapeSet& set);

constexpr std::size_t no_part = ~std::size_t(0);

// A tree over the parts: each hangs on one that can hold others, and those hang together so that the sum of the distances is the least
// (distances of pose_space, between the vertices of one and the surface of the other). The root, of those the part of the largest mass, hangs on none.
struct PartTree {
    std::vector<std::size_t> hosts; // per part; no_part: the root
    std::vector<std::size_t> order; // of parts: hosts before what hangs on them
};

// Per part, whether another may hang on it; only parts with faces can, and one does. Costs n log n for each of at most log2(parts)
// rounds (Boruvka 1926).
PartTree connect_parts(const Parts& parts, const std::vector<bool>& can_hold, const PartPoints& points,
                       const Eigen::VectorXd& masses);

} // namespace pliant
