// One character: weights in, positions and normals out, with the time that each step took. No graphics in here.
#pragma once

#include "blend/asset_file.h"
#include "blend/surface.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace pliant::player {

enum class BlendMode { elastic, linear };

// How much room the poses take, each standing on the floor: a box around them, and the points that stick out furthest in many
// directions, which outline them for a camera.
struct Extent {
    glm::vec3 lowest { 0.0f };
    glm::vec3 highest { 0.0f };
    std::vector<glm::vec3> outline;
};

// What one blend cost. The linear blend has no iterations; its solve time is that of the weighted sum.
struct BlendCost {
    pliant_solve_info info {};
    double solve_us = 0.0;
    double reconstruct_us = 0.0;
    double normals_us = 0.0;
};

// Medians of the costs of the last 60 blends.
class CostHistory {
public:
    void add(const BlendCost& cost);
    double median(double BlendCost::*field) const;

private:
    std::array<BlendCost, 60> costs_ {};
    std::size_t count_ = 0;
};

// The asset must outlive the character.
class Character {
public:
    // to_world turns the asset's axes into the world's (y up).
    Character(const AssetFile& file, const glm::mat3& to_world);

    // Blends and stands the result on the floor (y = 0). weights: pose_count numbers >= 0 with a positive sum. Throws Error.
    BlendCost blend(const std::vector<double>& weights, BlendMode mode);

    // Shows a shape that was made elsewhere: positions of the drawn surface in the asset's units. What it does not draw lies with its
    // first vertex.
    void show(const std::vector<glm::vec3>& positions);

    // Colours the vertices from now on (heat.h), one number each; empty: in the actor's own colour.
    void set_heat(const std::vector<float>& heat);

    // The next elastic blend starts afresh instead of from the last one.
    void forget();

    const std::vector<Vertex>& vertices() const { return vertices_; }
    // In the asset's units and axes, where the blend put them.
    const std::vector<glm::vec3>& positions() const { return positions_; }
    const AssetFile& file() const { return file_; }

private:
    const AssetFile& file_;
    glm::mat3 to_world_;
    std::vector<std::byte> solver_memory_;
    pliant_solver* solver_ = nullptr;
    std::vector<float> q_;
    std::vector<glm::vec3> positions_;
    std::vector<Vertex> vertices_;
};

Extent extent_of_poses(Character& character);

} // namespace pliant::player
