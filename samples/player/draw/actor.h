// The input of a scene: one actor for each character.
#pragma once

#include "blend/surface.h"

#include <pliant_gl.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace pliant::player {

// A shape in buffers of pliant::gl, in the asset's axes.
struct BuiltShape {
    pliant_gl_instance instance {};
    glm::mat4 placing { 1.0f };             // rotates it into the world and sets it on the floor; no scale
    std::vector<glm::vec3> blended_centres; // the mean of the vertices of each blended part (paint.h)
};

struct Actor {
    const std::vector<Vertex>* vertices = nullptr; // in the world, on the floor
    glm::vec3 offset { 0.0f };
    glm::vec3 colour { 0.5f };         // linear, not sRGB; for vertices without heat and paint
    const BuiltShape* built = nullptr; // if set, drawn instead of vertices
    float turn = 0.0f;                 // in radians, around the up axis through `axis`
    glm::vec3 axis { 0.0f };
};

inline glm::mat4 model_of(const Actor& actor)
{
    glm::mat4 place = glm::translate(glm::mat4(1.0f), actor.offset + actor.axis);
    place = glm::translate(glm::rotate(place, actor.turn, { 0.0f, 1.0f, 0.0f }), -actor.axis);
    return actor.built ? place * actor.built->placing : place;
}

} // namespace pliant::player
