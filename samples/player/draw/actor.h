// What a scene is told to draw.
#pragma once

#include "blend/surface.h"

#include <pliant_gl.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace pliant::player {

// A shape that pliant::gl has put into buffers, in the asset's axes.
struct BuiltShape {
    pliant_gl_instance instance {};
    glm::mat4 placing { 1.0f };             // turns it into the world and sets it down on the floor; no scale
    std::vector<glm::vec3> blended_centres; // for each blended part (paint.h) the mean of its vertices
};

struct Actor {
    const std::vector<Vertex>* vertices = nullptr; // in the world, on the floor
    glm::vec3 offset { 0.0f };
    glm::vec3 colour { 0.5f };         // linear, not sRGB; of vertices that have no heat, and are not painted
    const BuiltShape* built = nullptr; // instead of vertices
};

inline glm::mat4 model_of(const Actor& actor)
{
    const glm::mat4 offset = glm::translate(glm::mat4(1.0f), actor.offset);
    return actor.built ? offset * actor.built->placing : offset;
}

} // namespace pliant::player
