// The control polygon on the screen: drawing it, and turning places on the screen into points.
#pragma once

#include "blend/control_polygon.h"
#include "blend/truth.h"
#include "panels/overlay.h"

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
    float room;                   // pixels from the centre to where labels must end, to the left and to the right
    const Truth* truth = nullptr; // its weights are marked, those that are shown with a ring

    ImVec2 place(glm::dvec2 point) const;
    glm::dvec2 point(ImVec2 place) const;
    // The corner within `reach` pixels of a place.
    std::optional<std::uint32_t> corner_at(ImVec2 place, float reach) const;
};

// With labels and weights at the corners: two lines each up to 8 poses, one up to 16; of more poses the few largest weights.
void draw_polygon(ImDrawList* list, const Overlay& overlay, const PolygonView& view, const std::vector<double>& weights,
                  glm::dvec2 point, bool with_labels);

// The radius that leaves room for the labels of so many poses, in pixels of the design.
float polygon_radius(std::uint32_t pose_count);

// One colour per pose, spread over the hues.
ImU32 pose_colour(std::uint32_t pose, std::uint32_t pose_count, float alpha);

} // namespace pliant::player
