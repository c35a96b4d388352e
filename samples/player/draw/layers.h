// In which order blended parts are drawn. No graphics in here.
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

// All layers, the farthest first; equally far ones in the order of parts, then of actors. A layer is where the mean of its vertices is:
// right for parts that lie apart, as lenses, panes and layers of hair do. Parts that cut or surround each other, and a part's own faces,
// would have to be sorted by the face. blended: the vertices of each blended part.
std::vector<Layer> layers_of(const glm::mat4& view, const std::vector<Actor>& actors,
                             const std::vector<std::vector<std::uint32_t>>& blended);

} // namespace pliant::player
