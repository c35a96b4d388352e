// Even triangles on an implicit surface.
#pragma once

#include "field.h"

namespace pliant::creature {

// Wanted edge length at a point, relative to that of plain regions: 1 there, less at fine detail.
using Sizing = std::function<double(const Vec3&)>;

// Remeshes `mesh`, which lies near the zero level of `shape`, to about `vertex_count` vertices on that level with
// well-shaped triangles, in `rounds` rounds of split, collapse, flip and relax (Botsch and Kobbelt, "A Remeshing Approach
// to Multiresolution Modeling", SGP 2004). Keeps the topology. Cost: linear in vertices and rounds.
Mesh remesh(const Mesh& mesh, const Shape& shape, const Sizing& sizing, int vertex_count, int rounds);

} // namespace pliant::creature
