// The mesh that an asset draws in the place of a solid's own boundary: read, checked and embedded.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/render_mesh.h"

namespace pliant {

// Reads the surface, which lies where pose 0 is, and embeds it. It is only drawn: parts, borders, seams and vertices without a face
// are fine. Throws Failure: P1209 the poses are no solid, what read_mesh throws, P2606 a vertex far outside the solid, P2608 not a
// surface with area. Warning: P2607 vertices outside the solid.
DrawnSurface load_drawn_surface(const std::string& path, const PoseSet& poses, std::vector<Finding>* warnings = nullptr);

// The same for a mesh in memory, as read_mesh leaves one.
DrawnSurface embed_surface(MeshFile mesh, const PoseSet& poses, std::vector<Finding>* warnings = nullptr);

} // namespace pliant
