// Many characters of one asset, each with a solver of its own. No graphics in here.
#pragma once

#include "blend/character.h"
#include "blend/control_polygon.h"
#include "blend/weight_path.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <vector>

namespace pliant::player {

// What one frame of the whole crowd cost.
struct CrowdCost {
    double solve_us = 0.0;
    double reconstruct_us = 0.0;
    double normals_us = 0.0;
    double placing_us = 0.0; // by GpuCrowd instead: where on the processor floor and parts are,
    double update_us = 0.0;  // and positions and normals, until the driver says that they are done
    std::uint32_t evaluations = 0;
    std::uint32_t not_converged = 0;

    double rebuild_us() const { return reconstruct_us + normals_us + placing_us + update_us; }
};

class Crowd {
public:
    // count: at least 1. All solvers lie in one block of memory. The file must outlive the crowd. Throws Error.
    Crowd(const AssetFile& file, const glm::mat3& to_world, std::uint32_t count);

    // Solves all characters, one after the other on this thread: one row of pose_count weights each. Fills in the first, fourth and
    // fifth number of the cost.
    void solve(const std::vector<std::vector<double>>& weights, BlendMode mode, CrowdCost& cost);
    // Makes the vertices of all characters from what solve() found. GpuCrowd replaces this call and vertices(); it takes coordinates().
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
    std::vector<glm::vec3> positions_;          // of the character at work
    std::vector<std::vector<Vertex>> vertices_; // none before the first reconstruct()
};

// Weights of all characters at a phase (any number, period 1): each goes along the same loop, `path` or the idle path of the polygon,
// and starts elsewhere on it. The starts are spread evenly whatever the count.
std::vector<std::vector<double>> crowd_weights(std::uint32_t count, double phase, const ControlPolygon& polygon,
                                               const std::optional<WeightPath>& path);

// Seconds that one round of the loop takes.
double loop_seconds(const ControlPolygon& polygon, const std::optional<WeightPath>& path, double fps);

// Where characters stand that need `room` (their width and depth) each: rows one behind the other, away from +z, every second row
// shifted by half a place, the middle of all at the origin. More columns than rows.
std::vector<glm::vec3> crowd_places(std::uint32_t count, glm::vec2 room);

// The extent of copies of `one` at all places.
Extent extent_of_crowd(const Extent& one, const std::vector<glm::vec3>& places);

} // namespace pliant::player
