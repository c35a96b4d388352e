// Even triangles on an implicit surface.
#pragma once

#include "field.h"

namespace pliant::creature {

// Wanted edge length at a point, relative to the mesh's mean density: 1 on plain regions, less where detail is fine.
using Sizing = std::function<double(const Vec3&)>;

// Remeshes `mesh`, which lies near the zero level of `shape`, to about `vertex_count` well-shaped triangles on that level
// (Botsch and Kobbelt, "A Remeshing Approach to Multiresolution Modeling", SGP 2004: split, collapse, flip, relax), in
// `rounds` rounds. Topology is kept. Cost: linear in vertices and rounds.
Mesh remesh(const Mesh& mesh, const Shape& shape, const Sizing& sizing, int vertex_count, int rounds);

} // namespace pliant::creature
