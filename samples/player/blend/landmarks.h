// Where a few places of a shape are, from its coordinates and without its vertices: for shapes that only the graphics card has. No
// graphics in here.
#pragma once

#include <pliant.h>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace pliant::player {

// Positions are a constant and a sum of the coordinates times vectors (formats/SPEC.md): so are means of vertices, and so heights lie
// between a constant and a sum of the coordinates times intervals.
class Landmarks {
public:
    // groups: lists of vertices, none of them empty, whose means are wanted. Rebuilds all vertices once for each coordinate. The asset
    // must outlive the landmarks.
    Landmarks(const pliant_asset& asset, const glm::mat3& to_world, const std::vector<std::vector<std::uint32_t>>& groups);

    // The height of the lowest vertex in the world (its y), for coordinates q: rebuilds the few tiles of 64 vertices that may have it. All
    // of them where neighbours in number are no neighbours in space.
    float lowest(const float* q);
    // The mean of each group, in the asset's axes.
    void means(const float* q, std::vector<glm::vec3>& result) const;

    std::size_t rebuilt_tiles() const { return rebuilt_tiles_; } // by the last lowest()
    std::size_t tile_count() const { return bottoms_.size(); }

private:
    void probe(const std::vector<glm::vec3>& shape, const std::vector<glm::vec3>& origin, float step, std::size_t column);
    float lowest_of_tile(const float* q, std::uint32_t tile);

    const pliant_asset& asset_;
    glm::vec3 up_;        // height in the world: up_ times a position
    std::size_t columns_; // 1 + dimension: the constant, then one for each coordinate
    std::vector<std::vector<std::uint32_t>> groups_;
    std::vector<float> centres_, radii_;                   // [tile][column] of heights
    std::vector<glm::vec3> means_;                         // [group][column]
    std::vector<std::pair<float, std::uint32_t>> bottoms_; // of the last lowest(): nothing of the tile is below
    std::vector<glm::vec3> positions_;                     // of the tile at work
    std::size_t rebuilt_tiles_ = 0;
};

} // namespace pliant::player
