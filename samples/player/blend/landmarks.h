// The floor height and a few mean points of a shape, from its coordinates q alone: for shapes whose vertices are on the
// graphics card only.
#pragma once

#include <pliant.h>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace pliant::player {

// Positions are affine in the coordinates (formats/SPEC.md). So are means of vertices, and the heights in a tile lie in
// an interval whose ends follow from one interval per coordinate.
class Landmarks {
public:
    // groups: non-empty lists of vertices, whose means are wanted. Cost: reconstructs all vertices once for each
    // coordinate. The asset must outlive the landmarks.
    Landmarks(const pliant_asset& asset, const glm::mat3& to_world, const std::vector<std::vector<std::uint32_t>>& groups);

    // The height (world y) of the lowest vertex, for coordinates q. Reconstructs only the tiles that may contain it: few,
    // unless vertices with neighbouring numbers lie far apart.
    float lowest(const float* q);
    // The mean of each group, in the asset's axes.
    void means(const float* q, std::vector<glm::vec3>& result) const;

    std::size_t rebuilt_tiles() const { return rebuilt_tiles_; } // by the last lowest()
    std::size_t tile_count() const { return bottoms_.size(); }

private:
    void probe(const std::vector<glm::vec3>& shape, const std::vector<glm::vec3>& origin, float step, std::size_t column);
    float lowest_of_tile(const float* q, std::uint32_t tile);

    const pliant_asset& asset_;
    glm::vec3 up_;            // height in the world: dot(up_, position)
    std::uint32_t tile_size_; // vertices: 64, or a unit of pliant_reconstruct()
    std::size_t columns_;     // 1 + dimension: the constant, then one for each coordinate
    std::vector<std::vector<std::uint32_t>> groups_;
    std::vector<float> centres_, radii_;                   // [tile][column] of heights
    std::vector<glm::vec3> means_;                         // [group][column]
    std::vector<std::pair<float, std::uint32_t>> bottoms_; // of the last lowest(): a lower bound of the tile's heights
    std::vector<glm::vec3> positions_;                     // of the current tile
    std::size_t rebuilt_tiles_ = 0;
};

} // namespace pliant::player
