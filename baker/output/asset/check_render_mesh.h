// The surface that an asset draws in the place of its solid's boundary, blended by the runtime, next to the reference
// average.
#pragma once

#include "base/mesh/render_mesh.h"
#include "elastic/average/family.h"

namespace pliant {

class RuntimeBlender;

// At the vertices of the surface, weighted by its area; as ShapeError.
struct RenderMeshErrors {
    double mean = 0, largest = 0; // relative L2
    double largest_distance = 0;  // over the surface's bounding-box diagonal
};

// Blends of the asset against the surface embedded in the reference averages of `checks`, which are shapes of the solid.
RenderMeshErrors check_render_mesh(RuntimeBlender& blender, const NormalizedPoses& solid, const RenderMesh& surface,
                                   const std::vector<CheckPoint>& checks);

} // namespace pliant
