// Rigid alignment of two shapes.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace pliant::player {

// x becomes rotation * (x - centre) + target.
struct RigidMotion {
    glm::dmat3 rotation { 1.0 };
    glm::dvec3 centre { 0.0 };
    glm::dvec3 target { 0.0 };

    glm::dvec3 operator()(glm::dvec3 x) const { return rotation * (x - centre) + target; }
};

// The rotation and translation that bring the first `count` points of `from` closest to those of `onto`, by the sum of
// squared distances (Horn 1987). Never a reflection. Cost: two passes over the points.
RigidMotion best_motion(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& onto, std::size_t count);

} // namespace pliant::player
