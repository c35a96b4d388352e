// Unreduced averages: shapes that `pliant average` computed at listed weights, to compare blends with.
#pragma once

#include "blend/asset_file.h"
#include "blend/weight_path.h"

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace pliant::player {

// Vertex positions of a PLY file as the `pliant` tool writes it: binary little-endian, three float32 per vertex and
// nothing else, then the faces, of which only the size is checked. Throws Error (P5914) for another layout, a size that
// does not match the header, and numbers that are not finite.
std::vector<glm::vec3> read_ply_positions(const std::string& path);

// Holds all shapes in memory, 12 bytes per vertex.
class Truth {
public:
    // weights_file: a file for WeightPath. pattern: names of the meshes, such as "truth_%04d.ply"; line i, from 0,
    // belongs to mesh i. Throws Error: P5913, P5914, P5915 (a mesh of another character), P5941.
    Truth(const std::string& weights_file, const std::string& pattern, const AssetFile& asset);

    std::size_t count() const { return shapes_.size(); }
    const std::vector<double>& weights(std::size_t i) const { return weights_.row(i); }
    // In the asset's units and axes; boundary_vertex_count positions.
    const std::vector<glm::vec3>& shape(std::size_t i) const { return shapes_[i]; }

    // The shape whose weights are nearest, by the sum of absolute differences.
    std::size_t nearest(const std::vector<double>& weights) const;

private:
    WeightPath weights_;
    std::vector<std::vector<glm::vec3>> shapes_;
};

} // namespace pliant::player
