// Polygons to triangles, alike in all poses.
#pragma once

#include "base/mesh/pose_set.h"

namespace pliant {

// The triangles of a mesh and the polygon that each was cut from.
struct Triangulation {
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> faces; // per triangle
};

// A fan from the first corner of every polygon: c0 c1 c2, c0 c2 c3, ... It looks at no positions, so it is the same for all
// poses.
Triangulation triangulate(const Polygons& polygons);

} // namespace pliant
