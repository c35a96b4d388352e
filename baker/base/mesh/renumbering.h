// Are two meshes the same but for the numbers of their vertices?
#pragma once

#include "base/mesh/pose_set.h"

namespace pliant {

// If face f of one mesh is face f of the other, corner by corner, under one renumbering of the vertices.
bool equal_under_row_renumbering(const Polygons& a, const Polygons& b, std::size_t vertex_count);

// Colours of the vertices after a few rounds in which each learns what is around it (Weisfeiler and Leman 1968), sorted:
// equal for meshes that differ in numbering only, and different for nearly all others.
std::vector<std::uint64_t> sorted_colours(const Polygons& faces, std::size_t vertex_count);

} // namespace pliant
