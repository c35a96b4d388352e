// The order in which blended parts are drawn. No OpenGL.
#pragma once

#include "draw/actor.h"

#include <cstddef>
#include <cstdint>

namespace pliant::player {

// One blended part of one actor.
struct Layer {
    float depth = 0.0f; // along the view direction, from the eye
    std::size_t actor = 0, blended = 0;
};

// All layers, the farthest first; at equal depth in the order of parts, then of actors. The depth of a layer is that of
// the mean of its vertices. That is right for separate parts, such as lenses, panes and layers of hair; parts that
// intersect or enclose each other, and the faces within a part, would need sorting by face. blended: the vertices of each
// blended part.
std::vector<Layer> layers_of(const glm::mat4& view, const std::vector<Actor>& actors,
                             const std::vector<std::vector<std::uint32_t>>& blended);

} // namespace pliant::player
