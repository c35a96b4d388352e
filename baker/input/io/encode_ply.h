// PLY as Pliant writes it.
#pragma once

#include "base/mesh/pose_set.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pliant {

// A binary little-endian PLY file in memory: float32 positions, vertices in the order given, faces as given. Lists are
// counted by uchar unless a face has more than 255 corners, indices are int. The same input gives the same bytes on every
// machine. positions: vertex_count times x y z, densely.
std::string encode_ply(const float* positions, std::size_t vertex_count, const Polygons& faces);

// The same, rounding to float32.
std::string encode_ply(const Positions& positions, const Polygons& faces);

// How the vertices of a solid are numbered: as PoseSet has it. Of a surface both are empty and nothing is renumbered.
struct VertexNumbers {
    std::vector<std::uint32_t> sources; // per vertex its number in the files
    std::size_t boundary_count = 0;     // leading vertices, which the faces use
};

// Of a surface: all vertices and faces, as in the files. Of a solid: its boundary, and with it either the vertices that it
// uses (numbered as here) or, with `all_vertices`, all of them in the order of the files, so that vertex i of the result is
// vertex i of a pose file.
std::string encode_ply(const Positions& positions, const Polygons& faces, const VertexNumbers& numbers, bool all_vertices);

// The same for a shape of a pose set, with the vertices that it draws.
std::string encode_ply(const Positions& positions, const PoseSet& poses, bool all_vertices = false);

} // namespace pliant
