// Shapes that `pliant average` computed without reduction at listed weights, to show beside blends. No graphics in here.
#pragma once

#include "blend/asset_file.h"
#include "blend/weight_path.h"

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace pliant::player {

// Positions of the vertices in a PLY file as the `pliant` tool writes it: binary little-endian, three float32 per vertex and nothing
// else, then the faces, which are checked for their size only. Throws Error (P5914) for anything else: another layout, a size that
// is not that of the header, a number that is not finite.
std::vector<glm::vec3> read_ply_positions(const std::string& path);

// All shapes are in memory: 12 bytes a vertex.
class Truth {
public:
    // weights_file: as WeightPath reads it; pattern: names of the meshes, "truth_%04d.ply", number i for line i, from 0. Throws Error:
    // P5913, P5914, P5915 (a mesh of another character), P5941.
    Truth(const std::string& weights_file, const std::string& pattern, const AssetFile& asset);

    std::size_t count() const { return shapes_.size(); }
    const std::vector<double>& weights(std::size_t i) const { return weights_.row(i); }
    // In units and place of the asset; as many as the drawn surface has.
    const std::vector<glm::vec3>& shape(std::size_t i) const { return shapes_[i]; }

    // The line whose weights are nearest, by the sum of absolute differences.
    std::size_t nearest(const std::vector<double>& weights) const;

private:
    WeightPath weights_;
    std::vector<std::vector<glm::vec3>> shapes_;
};

} // namespace pliant::player
