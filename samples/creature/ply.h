// Binary PLY files, written completely or not at all.
#pragma once

#include "types.h"

#include <string>

namespace pliant::creature {

struct PlyFile {
    std::string path;
    const std::vector<Vec3>& points;
};

// Writes meshes with the same faces: float32 positions, little-endian. Writes every file under a temporary name in the
// same folder, and renames them in order once all are complete. Throws std::runtime_error with the file and the reason;
// no temporary file is left behind.
void write_ply_set(const std::vector<PlyFile>& files, const std::vector<Face>& faces);

} // namespace pliant::creature
