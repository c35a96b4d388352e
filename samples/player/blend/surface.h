// From the coordinates of an asset to vertices for the renderer.
#pragma once

#include <pliant.h>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace pliant::player {

// Positions are in the asset's units, with the world's y up. heat: 0 to 1, see heat.h; -1: the actor's own colour.
struct Vertex {
    glm::vec3 position { 0.0f };
    glm::vec3 normal { 0.0f }; // of any length; the shader normalises it
    float heat = -1.0f;
};

// Measures time from its construction.
class Stopwatch {
public:
    Stopwatch();
    double microseconds() const;

private:
    long long start_; // nanoseconds
};

// The coordinates of the linear blend. weights: weight_count numbers. Of averages, whose sum must be positive, it is the
// weighted mean of the poses' coordinates, of layers the rest shape plus the weighted differences of the layers from it.
void blend_linearly(const pliant_asset& asset, const std::vector<double>& weights, std::vector<float>& q);

// The weights whose linear blend is a pose. Of layers pose 0 is the rest shape, and the others are layers at 1.
std::vector<double> weights_of_pose(const pliant_asset& asset, std::uint32_t pose);

// Smooth normals: the area-weighted sum of the adjacent faces' normals, over all vertices that share a normal.
void compute_normals(const pliant_asset& asset, const std::vector<glm::vec3>& positions, std::vector<Vertex>& vertices);

// Rotates positions and normals into the world and sets the surface on the floor, y = 0.
void stand_on_floor(const glm::mat3& to_world, const std::vector<glm::vec3>& positions, std::vector<Vertex>& vertices);

} // namespace pliant::player
