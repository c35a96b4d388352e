// Distances between two shapes, as colours on a logarithmic scale.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace pliant::player {

// The ends of the scale, as shares of the diagonal of the first pose's bounding box. Below the lower end a difference is not
// visible (a tenth of a pixel in a picture of a thousand rows); above the upper end the shapes have nothing in common.
constexpr float lowest_heat = 1e-4f;
constexpr float highest_heat = 1e-1f;

// Colours along the scale, evenly spaced, sRGB: from pale blue, which no surface without a distance has, to dark violet.
using HeatColours = std::array<glm::vec3, 6>;
constexpr HeatColours heat_colours { { { 0.730f, 0.880f, 0.960f },
                                       { 0.980f, 0.870f, 0.520f },
                                       { 0.965f, 0.610f, 0.280f },
                                       { 0.850f, 0.280f, 0.240f },
                                       { 0.560f, 0.110f, 0.310f },
                                       { 0.240f, 0.050f, 0.260f } } };
// The heat of a shape from which others have their distances; it is hatched.
constexpr float reference_heat = -2.0f;

HeatColours linear_heat_colours(); // the same, linear instead of sRGB

// Position of a share of the diagonal on the scale: 0 at its lower end and below, 1 at its upper end and above.
float heat_of_share(float share);

// Distances of all vertices as shares of the diagonal.
struct HeatSummary {
    float mean = 0.0f, largest = 0.0f;
};

// Moves `a` rigidly to where it is closest to `b`, so that only a difference in shape remains, and writes the heat of the
// distance between a[v] and b[v] to heat[v], for the first `count` vertices. heat keeps its size; further entries become 0.
HeatSummary measure_heat(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b, std::size_t count, float diagonal,
                         std::vector<float>& heat);

// The diagonal of the bounding box of the first `count` positions.
float diagonal_of(const std::vector<glm::vec3>& positions, std::size_t count);

} // namespace pliant::player
