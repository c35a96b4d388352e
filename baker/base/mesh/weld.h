// Which vertices of a surface are one: files split them at seams of texture, material and shading, the body is not cut
// there.
#pragma once

#include "base/mesh/pose_set.h"

namespace pliant {

// Part of the bounding-box diagonal within which vertices count as one by default. What exporters and skinning in single
// precision make of one point differs by a few units of its last place, 6e-8 of the largest coordinate; the runtime's own
// positions are no finer than 1e-6 of the size.
constexpr double default_weld_tolerance = 1e-6;

// Per vertex the one that stands for it: the lowest number of those that lie within 2 `tolerance` diagonals of it in all
// poses, by which vertices that touch in one pose only stay apart; itself if there is none. A `tolerance` of 0: every vertex
// stands for itself. Cost: sorting, and at most 576 comparisons for each vertex. A mesh that needs more has thousands of
// vertices that lie within a few `tolerance` and are still apart; some of its vertices stay apart that could be one.
std::vector<std::uint32_t> weld(const std::vector<const Positions*>& poses, double tolerance);

} // namespace pliant
