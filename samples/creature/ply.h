// Binary PLY files, written whole or not at all.
#pragma once

#include "types.h"

#include <string>

namespace pliant::creature {

struct PlyFile {
    std::string path;
    const std::vector<Vec3>& points;
};

// Writes a set of meshes with the same faces: float32 positions, little-endian. Every file is first written under a
// temporary name beside its own; only when all are complete are they renamed, in order. Throws std::runtime_error naming
// the file and the reason; no temporary file is left then.
void write_ply_set(const std::vector<PlyFile>& files, const std::vector<Face>& faces);

} // namespace pliant::creature
