// A mesh compressed with Draco, vertices in their order.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace pliant {

struct DracoMesh {
    std::string bytes;
    std::uint32_t position_id = 0, normal_id = 0; // of the attributes, for KHR_draco_mesh_compression
    std::vector<float> positions;                 // as a decoder gives them, 3n
    double largest_error = 0;                     // of a coordinate, input units
};

// Compresses in sequential encoding, which keeps the order of vertices and faces (edgebreaker does not): positions to a grid
// of 2^20 steps along the longest side, normals in 12 bits a coordinate of the octahedron. Decodes the result to see what
// came out. Throws Failure (failed, P5206) if Draco refuses or gives back another mesh.
DracoMesh compress_mesh(const std::vector<float>& positions, const std::vector<float>& normals,
                        const std::vector<std::uint32_t>& triangles);

} // namespace pliant
