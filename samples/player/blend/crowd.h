// Many characters of one asset, each with its own solver.
#pragma once

#include "blend/character.h"
#include "blend/control_polygon.h"
#include "blend/weight_path.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <vector>

namespace pliant::player {

// Cost of one frame, summed over the whole crowd.
struct CrowdCost {
    double solve_us = 0.0;
    double reconstruct_us = 0.0;
    double normals_us = 0.0;
    double placing_us = 0.0; // GpuCrowd: floor heights and part centres, on the processor
    double update_us = 0.0;  // GpuCrowd: positions and normals, until the driver reports completion
    std::uint32_t evaluations = 0;
    std::uint32_t not_converged = 0;

    double rebuild_us() const { return reconstruct_us + normals_us + placing_us + update_us; }
};

class Crowd {
public:
    // count: at least 1. All solvers share one block of memory. The file must outlive the crowd. Throws Error.
    Crowd(const AssetFile& file, const glm::mat3& to_world, std::uint32_t count);

    // Solves all characters one after the other on this thread; weights: one row of weight_count numbers per character.
    // Sets the cost's solve_us, evaluations and not_converged.
    void solve(const std::vector<std::vector<double>>& weights, BlendMode mode, CrowdCost& cost);
    // Computes vertices() of all characters from the result of solve(), and sets reconstruct_us and normals_us. Not
    // needed with GpuCrowd, which starts from coordinates().
    void reconstruct(CrowdCost& cost);

    std::uint32_t count() const { return static_cast<std::uint32_t>(solvers_.size()); }
    const std::vector<float>& coordinates(std::uint32_t character) const { return q_[character]; }
    const std::vector<Vertex>& vertices(std::uint32_t character) const { return vertices_[character]; }
    std::size_t solver_bytes() const { return solver_bytes_; } // of one character

private:
    const AssetFile& file_;
    glm::mat3 to_world_;
    std::size_t solver_bytes_;
    std::vector<std::byte> memory_;
    std::vector<pliant_solver*> solvers_;
    std::vector<std::vector<float>> q_;
    std::vector<float> weights_;
    std::vector<glm::vec3> positions_;          // of the current character
    std::vector<std::vector<Vertex>> vertices_; // empty before the first reconstruct()
};

// Weights of all characters at a phase (any number, period 1). All follow the same loop, `path` or the polygon's idle
// path, from different starts, which are evenly spread for any count.
std::vector<std::vector<double>> crowd_weights(std::uint32_t count, double phase, const ControlPolygon& polygon,
                                               const std::optional<WeightPath>& path);

// Duration of one round of the loop, in seconds.
double loop_seconds(const ControlPolygon& polygon, const std::optional<WeightPath>& path, double fps);

// Places for `count` characters, each of which needs `room` (width and depth): rows one behind the other, away from +z,
// every second row shifted by half a place, all centred at the origin. More columns than rows.
std::vector<glm::vec3> crowd_places(std::uint32_t count, glm::vec2 room);

// How a character of a crowd differs from the first one: `own` is -1 to 1, even for neighbours far apart. It turns by own
// times the largest turn, in radians, around the up axis through the centre of its extent.
float crowd_variation(std::uint32_t character);
constexpr float largest_crowd_turn = 0.42f;
// The extent of one character with all these turns.
Extent extent_with_turns(const Extent& one);

// The extent of copies of `one` at all places.
Extent extent_of_crowd(const Extent& one, const std::vector<glm::vec3>& places);

} // namespace pliant::player
