// The control polygon on the screen: draws it, and converts screen positions to points.
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
    float room;                   // pixels from the centre to the limit of labels, left and right
    const Truth* truth = nullptr; // if set, its weights are marked, and the shown weights have a ring

    ImVec2 place(glm::dvec2 point) const;
    glm::dvec2 point(ImVec2 place) const;
    // The corner within `reach` pixels of a screen position.
    std::optional<std::uint32_t> corner_at(ImVec2 place, float reach) const;
};

// A hollow point: its weights are others than those shown, which no point has.
// Labels: names and weights at the corners, on two lines each for up to 8 poses and on one line for up to 16. With more
// poses only the few largest weights have labels.
void draw_polygon(ImDrawList* list, const Overlay& overlay, const PolygonView& view, const std::vector<double>& weights,
                  glm::dvec2 point, bool with_labels);

// The radius that leaves room for the labels of `pose_count` poses, in pixels of the design.
float polygon_radius(std::uint32_t pose_count);

// One colour per pose, evenly spread over the hues.
ImU32 pose_colour(std::uint32_t pose, std::uint32_t pose_count, float alpha);

} // namespace pliant::player
