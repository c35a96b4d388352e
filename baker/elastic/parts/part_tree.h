// The tree of parts: which part is attached to which.
#pragma once

#include "elastic/parts/part_points.h"

namespace pliant {

// The parts that can be parents form a minimum spanning tree. The distance of two parts is the smallest distance in pose
// space between a vertex of one and the surface of the other. The root is the part of largest mass among them. Every other
// part is attached to the nearest part that can be a parent.
struct PartTree {
    std::vector<std::size_t> parents; // per part; no_part for the root
    std::vector<std::size_t> order;   // all parts, parents before their children
};

// `can_be_parent`, per part: true only for parts with faces, and for at least one of them. `masses`: per vertex.
// Cost: n log n per round, at most log2(parts) rounds (Boruvka 1926).
PartTree connect_parts(const Parts& parts, const std::vector<bool>& can_be_parent, const PartPoints& points,
                       const Eigen::VectorXd& masses);

} // namespace pliant
