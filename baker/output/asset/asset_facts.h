// Facts of an asset that several verbs tell, so that they tell the same.
#pragma once

#include "pliant.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pliant {

struct ChunkFact {
    std::string tag; // four characters, '?' for what cannot be printed
    std::uint64_t offset = 0, size = 0;
};

// The chunks in the order of the table.
std::vector<ChunkFact> asset_chunks(const pliant_asset& asset);

// Bytes of the basis, compact or not.
std::uint64_t basis_size(const pliant_asset& asset);

// What a frame reads to rebuild all vertices: basis and rest positions.
std::uint64_t frame_size(const pliant_asset& asset);

// "1.4"
std::string format_version(const pliant_asset& asset);

// Whether the asset draws a surface of its own and not the mesh of its poses, by its certificate (JSON text).
bool has_render_mesh(const std::string& certificate);

} // namespace pliant
