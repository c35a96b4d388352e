// Meshes compressed by KHR_draco_mesh_compression, through Draco's own decoder.
#pragma once

#include "base/mesh/pose_set.h"
#include "input/gltf/accessor.h"

#include <map>
#include <string>
#include <vector>

namespace pliant {

// JOINTS_k and WEIGHTS_k with k below this are read: more than any engine takes.
constexpr int influence_set_count = 4;

// A decoded primitive. Vertices come in the decoder's order, which is what every engine gets.
struct DracoMesh {
    std::vector<Triangle> triangles;               // corners below vertex_count
    std::map<std::string, GltfNumbers> attributes; // those that are read, by glTF's names, vertex_count rows each
    std::uint64_t vertex_count = 0;
    std::map<std::string, double> steps; // of the grids that attributes were rounded to, by glTF's names; 0: none
};

// `extension` is the object KHR_draco_mesh_compression of a primitive, `attributes` the primitive's own: they say which
// numbers are normalized. What is made is taken from `allowance`. Throws Failure: P2318 (not decodable, or an attribute
// missing), P2306 to P2308, P2333.
DracoMesh decode_draco(const GltfDocument& document, const GltfValue& extension, const GltfValue& attributes,
                       GltfAllowance& allowance);

} // namespace pliant
