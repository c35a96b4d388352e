// What is drawn, where that is not the mesh of the elastic energy: a fine surface that rides on coarse tetrahedra in the
// place of their own boundary, or a surface as its file has it, with seams that are welded for the energy and faces that
// have none.
#pragma once

#include "base/mesh/embedding.h"
#include "base/mesh/normalized_poses.h"

namespace pliant {

struct RenderMesh {
    Polygons polygons; // as the file gave them
    std::vector<Triangle> triangles;
    Embedding embedding;           // in pose 0, by the numbers of PoseSet
    std::size_t outside_count = 0; // vertices outside the solid
    double farthest_outside = 0;   // over the bounding-box diagonal of pose 0
    double largest_weight = 1;     // of a corner, in absolute value: more than 1 lifts the motion of that corner
};

// Vertices that each lie exactly where vertex `places[v]` of the elastic mesh does.
std::shared_ptr<const RenderMesh> copy_to_render_mesh(Polygons polygons, std::vector<Triangle> triangles,
                                                      const std::vector<std::uint32_t>& places);

// The shapes of the surface in the poses of the solid, to measure its blends by: in the solid's units, around its origin. It
// has no elements; fixed_vertices are the solid's, and say only whether shapes are held.
NormalizedPoses render_mesh_shapes(const NormalizedPoses& solid, const RenderMesh& surface);

// Where the vertices of the surface are when those that they hang on are at `positions`.
Positions render_mesh_positions(const RenderMesh& surface, const Positions& positions);

} // namespace pliant
