// The control polygon on the screen: drawing it, and turning places on the screen into points.
#pragma once

#include "control_polygon.h"
#include "overlay.h"
#include "truth.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant::player {

struct PolygonView {
    const ControlPolygon& polygon;
    const std::vector<std::string>& names;
    ImVec2 centre;
    float radius;                 // pixels from the centre to a corner
    const Truth* truth = nullptr; // its weights are marked, those that are shown with a ring

    ImVec2 place(glm::dvec2 point) const;
    glm::dvec2 point(ImVec2 place) const;
    // The corner within `reach` pixels of a place.
    std::optional<uint32_t> corner_at(ImVec2 place, float reach) const;
};

// With labels and weights at the corners if they have room (up to 16 poses).
void draw_polygon(ImDrawList* list, const Overlay& overlay, const PolygonView& view, const std::vector<double>& weights,
                  glm::dvec2 point, bool with_labels);

// One colour per pose, spread over the hues.
ImU32 pose_colour(uint32_t pose, uint32_t pose_count, float alpha);

} // namespace pliant::player
