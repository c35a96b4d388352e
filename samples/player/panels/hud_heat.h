// What stands over the scene itself: names below the characters, the scale of the distances.
#pragma once

#include "draw/camera.h"
#include "panels/overlay.h"
#include "panels/shown.h"

namespace pliant::player {

// Below each of several characters its name, with heat also its distances.
void draw_side_captions(const Overlay& overlay, const Shown& shown, const Area& free);

// The colours and the distances that they stand for, at the top of the free area. Draws nothing without heat.
void draw_heat_legend(const Overlay& overlay, const Shown& shown, const Area& free);

} // namespace pliant::player
