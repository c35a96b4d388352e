// Seams between the parts of a compressed file. Each part has its vertices rounded to a grid of its own, and the two copies
// of a vertex of a seam no longer coincide.
#pragma once

#include "base/mesh/pose_set.h"

namespace pliant {

struct RoundedParts {
    std::vector<std::uint32_t> of_vertex; // per vertex the number of its part
    // Parts x poses: how far rounding moves a vertex, at most; 0: too far, the part stays as it is.
    Eigen::MatrixXd reaches;
};

// Joins border edges of different parts whose ends lie within their two reaches of each other in all poses, the nearest
// first, and never two vertices of one part: within a part equal vertices are rounded alike, and weld() joins them. Two
// parts whose borders are farther apart on average than rounding explains stay apart: they are layers. `targets`: what
// weld() returned; afterwards one of the finest part stands for the others. The number of vertices joined. Cost: n log n in
// the border vertices; where thousands of them crowd within a reach, some stay apart.
std::size_t weld_seams(const std::vector<const Positions*>& poses, const std::vector<Triangle>& triangles,
                       const RoundedParts& parts, std::vector<std::uint32_t>& targets);

} // namespace pliant
