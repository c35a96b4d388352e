// Tiles of vertices that lie close to each other: those of chunk BASF of formats/SPEC.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

namespace pliant {

// Numbers of vertices, ascending.
using VertexTile = std::vector<std::uint32_t>;

// Cuts each run of `block_vertices` consecutive vertices at medians of `rest` (3n) until tiles have at most 64 vertices.
// Vertices of different `kind_of(vertex)` do not share a tile, and tiles of lower kinds come first. Vertices at the same
// place stay together: they get the same numbers, so that seams do not open. Returns the tiles of each block.
std::vector<std::vector<VertexTile>> cut_tiles(const Eigen::VectorXd& rest, std::uint32_t block_vertices,
                                               const std::function<int(std::uint32_t)>& kind_of);

} // namespace pliant
