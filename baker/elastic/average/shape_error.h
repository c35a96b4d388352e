// How far a blend is from the reference average.
#pragma once

#include "base/mesh/align.h"
#include "elastic/energy/energy.h"

namespace pliant {

// Relative errors of blended shapes against the unreduced averages: after rigid alignment, unless the poses stay where they
// are (NormalizedPoses::frame).
struct ShapeError {
    double relative_l2 = 0;      // mass-weighted, relative to the distance from the centroid
    double largest_distance = 0; // over the bounding-box diagonal of pose 0
    double energy_excess = 0;    // (W(blend) - W(average)) / W(average); of layers not a number
};

ShapeError shape_error(const Energy& energy, const NormalizedPoses& set, const Weights& w, const Shape& blend,
                       const Shape& reference);

// The distances alone; energy_excess is 0.
ShapeError shape_distance(const NormalizedPoses& set, const Shape& blend, const Shape& reference);

// The first of them alone. Cost: linear in the vertices.
double relative_error(const NormalizedPoses& set, const Shape& blend, const Shape& reference);

// The same without alignment in any case: how far a shape has moved.
double relative_move(const NormalizedPoses& set, const Shape& from, const Shape& to);

// The same after rigid alignment in any case: how different two shapes are, wherever they lie.
double relative_distance(const NormalizedPoses& set, const Shape& blend, const Shape& reference);

} // namespace pliant
