// The panels over a single character: the kind of blend, its cost, the control polygon, the sliders, the keys.
#pragma once

#include "blend/character.h"
#include "blend/control_polygon.h"
#include "blend/truth.h"
#include "panels/hud_parts.h"
#include "panels/shown.h"
#include "panels/sliders.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant::player {

// The contents of the panels. References must outlive the call of draw_hud().
struct HudModel {
    const AssetFile& file;
    const ControlPolygon& polygon;
    const Shown& shown;
    const Truth* truth = nullptr;
    std::vector<double> weights {}; // as requested; shown.weights may be those of an unreduced average
    glm::dvec2 point { 0.0 };
    std::optional<double> path_frame {}; // set while a path is shown
    std::size_t path_count = 0;
    bool help = true;
    bool has_paint = false;
    double solve_us = 0.0; // medians
    double reconstruct_us = 0.0;
    double normals_us = 0.0;
};

// The user's input in the panels.
struct HudActions {
    std::optional<glm::dvec2> drag_to;
    std::optional<std::uint32_t> go_to; // a corner
    std::optional<Show> show;
    SliderActions sliders;
};

HudActions draw_hud(const Overlay& overlay, const HudModel& model, SliderState& sliders, int width, int height);

} // namespace pliant::player
