// From an implicit shape to a first triangle mesh.
#pragma once

#include "field.h"

namespace pliant::creature {

// The zero level of `shape` inside the box, by marching tetrahedra (six per cell of a cubic grid): always a closed oriented
// manifold, but with poor triangles. Throws std::runtime_error if the surface reaches the border of the box.
Mesh polygonise(const Shape& shape, const Vec3& box_min, const Vec3& box_max, double cell);

} // namespace pliant::creature
