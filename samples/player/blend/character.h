// One character: weights in, positions and normals out, with the time of each step.
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

// The space that all blends take, each standing on the floor: their bounding box, and the farthest points in many
// directions, to which a camera fits its view.
struct Extent {
    glm::vec3 lowest { 0.0f };
    glm::vec3 highest { 0.0f };
    std::vector<glm::vec3> outline;
};

// Cost of one blend. The linear blend has no iterations; its solve time is the time of the weighted sum.
struct BlendCost {
    pliant_solve_info info {};
    double solve_us = 0.0;
    double reconstruct_us = 0.0;
    double normals_us = 0.0;
};

// Medians over the last 60 blends.
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
    // to_world: rotation from the asset's axes to the world's (y up).
    Character(const AssetFile& file, const glm::mat3& to_world);

    // Blends and sets the result on the floor (y = 0). weights: weight_count numbers, of averages >= 0 with a positive sum.
    // Throws Error.
    BlendCost blend(const std::vector<double>& weights, BlendMode mode);

    // Takes a shape that was computed elsewhere: positions of the drawn vertices, in the asset's units. All other
    // vertices are put at the first one.
    void show(const std::vector<glm::vec3>& positions);

    // Colours the vertices from now on (heat.h), one number for each; empty: in the actor's own colour.
    void set_heat(const std::vector<float>& heat);

    // Lets the next elastic blend start cold instead of from the last one.
    void forget();

    const std::vector<Vertex>& vertices() const { return vertices_; }
    // In the asset's units and axes, before they are set on the floor.
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

// Collects the extent of shapes.
class ExtentOfShapes {
public:
    ExtentOfShapes();
    void add(const std::vector<Vertex>& vertices);
    const Extent& extent() const { return extent_; }

private:
    // About 20 degrees apart: what lies between them is missed by about 1 % of the size.
    static constexpr int direction_count = 96;

    std::vector<glm::vec3> directions_;
    std::vector<float> furthest_;
    Extent extent_;
};

// Of all poses; of layers also of those mixtures that the player shows by itself (layer_walk.h).
Extent extent_of_poses(Character& character);

// Throws the error for weights that the runtime refused.
[[noreturn]] void refuse_weights(const pliant_asset& asset, pliant_result result);

} // namespace pliant::player
