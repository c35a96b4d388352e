// The mesh that an asset draws in the place of a solid's own boundary: read, checked and embedded.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/render_mesh.h"

namespace pliant {

// Reads the surface, which lies where pose 0 is, and embeds it. It is only drawn: parts, borders, seams and vertices without
// a face are fine. Throws Failure: P1209 the poses are no solid, what read_mesh throws, P2606 a vertex far outside the
// solid, P2608 not a surface with area. Warning: P2607 vertices outside the solid.
RenderMesh load_render_mesh(const std::string& path, const PoseSet& poses, std::vector<Diagnostic>* warnings = nullptr);

// The same for a mesh in memory, as read_mesh leaves one.
RenderMesh embed_render_mesh(MeshFile mesh, const PoseSet& poses, std::vector<Diagnostic>* warnings = nullptr);

} // namespace pliant
