// Tiles of vertices that lie close to each other: those of chunk BASF of formats/SPEC.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

namespace pliant {

// Numbers of vertices, ascending.
using VertexTile = std::vector<std::uint32_t>;

// Cuts each run of `vertices_per_block` consecutive vertices at medians of `rest` (3n) until tiles have at most 64 vertices.
// Vertices of different `kind_of(vertex)` do not share a tile. Those at the same place share one, so that they get the same
// numbers and seams do not open: tiles of places that several blocks have reach over these, and a tile has more than 64
// vertices (at most 1024) if all of them are at one place.
std::vector<VertexTile> cut_tiles(const Eigen::VectorXd& rest, std::uint32_t vertices_per_block,
                                  const std::function<int(std::uint32_t)>& kind_of);

} // namespace pliant
