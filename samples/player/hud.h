// The panels over the scene: what is shown, what it costs, the control polygon, the keys.
#pragma once

#include "camera.h"
#include "character.h"
#include "control_polygon.h"
#include "overlay.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant::player {

enum class Show { elastic, linear, both };

// What the panels tell. References outlive the call.
struct HudModel {
    const AssetFile& file;
    const ControlPolygon& polygon;
    const std::vector<double>& weights;
    glm::dvec2 point { 0.0 };
    Show show = Show::elastic;
    bool plays = false;
    bool help = true;
    BlendCost cost {};     // of this frame
    double solve_us = 0.0; // medians
    double reconstruct_us = 0.0;
    double normals_us = 0.0;
};

// What the user did with them.
struct HudActions {
    std::optional<glm::dvec2> drag_to;
    std::optional<uint32_t> go_to; // a corner
    std::optional<Show> show;
    bool toggle_play = false;
};

HudActions draw_hud(const Overlay& overlay, const HudModel& model, int width, int height);

// The part of the picture that the panels leave free.
Area free_area(float scale, int width, int height);

// "linear" and "elastic" below the two characters that stand side by side.
void draw_side_captions(const Overlay& overlay, const Area& free);

} // namespace pliant::player
