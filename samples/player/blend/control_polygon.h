// The control polygon: one corner per pose; a point inside it gives the blend weights.
#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <vector>

namespace pliant::player {

// A regular polygon in the unit circle, counter-clockwise with y up, the first corner on top (four corners: top left);
// for two poses the segment from (-1, 0) to (1, 0). Points are in these units.
class ControlPolygon {
public:
    // corner_count: at least 2.
    explicit ControlPolygon(std::uint32_t corner_count);

    std::uint32_t corner_count() const { return static_cast<std::uint32_t>(corners_.size()); }
    const std::vector<glm::dvec2>& corners() const { return corners_; }

    // Wachspress coordinates of a point: corner_count weights, >= 0, sum 1. Exactly one nonzero weight at a corner, two
    // on an edge; smooth inside. A point outside is moved to the nearest point inside. (Wachspress 1975, in the product
    // form, which needs no division that fails on the boundary.) Cost: corner_count^2 multiplications.
    std::vector<double> weights(glm::dvec2 point) const;

    // The weighted mean of the corners. The inverse of weights() for two and three corners only: with more corners,
    // different weights can give the same point.
    glm::dvec2 point(const std::vector<double>& weights) const;

    // The nearest point of the polygon, `point` itself if it is inside.
    glm::dvec2 nearest_inside(glm::dvec2 point) const;

    // The idle path: a smooth closed path inside the polygon that comes to rest at each corner. phase: any number, period 1;
    // 0 is the first corner.
    glm::dvec2 idle_point(double phase) const;

    // The phase at which idle_point() is nearest to `point`, for continuing the path from there.
    double idle_phase_near(glm::dvec2 point) const;

private:
    double side(std::uint32_t edge,
                glm::dvec2 point) const; // twice the signed area of the triangle (edge, point), > 0 inside

    std::vector<glm::dvec2> corners_;
};

} // namespace pliant::player
