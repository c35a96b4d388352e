// Captions in the scene: names below the characters, and the colour scale of the distances.
#pragma once

#include "draw/camera.h"
#include "panels/overlay.h"
#include "panels/shown.h"

namespace pliant::player {

// The part of the free area that captions and colour scale leave to the characters. scale: pixels per pixel of the design.
Area without_captions(const Shown& shown, Area free, float scale);

// The name below each character if there are several, and with heat its distances. places: below the feet.
void draw_side_captions(const Overlay& overlay, const Shown& shown, const Area& free, const std::vector<glm::vec2>& places);

// The colour scale of the distances, at the top of the free area. Draws nothing without heat.
void draw_heat_legend(const Overlay& overlay, const Shown& shown, const Area& free);

} // namespace pliant::player
