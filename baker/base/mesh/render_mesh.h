// What is drawn, where that is not the mesh of the elastic energy: a fine surface that rides on coarse tetrahedra in the place of their
// own boundary, or a surface as its file has it, with seams that are welded for the energy and faces that have none.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/align.h"
#include "base/mesh/embedding.h"

namespace pliant {

struct DrawnSurface {
    Polygons polygons; // as the file gave them
    std::vector<Triangle> triangles;
    Embedding embedding;           // in pose 0, by the numbers of PoseSet
    std::size_t outside_count = 0; // vertices outside the solid
    double farthest_outside = 0;   // over the bounding-box diagonal of pose 0
    double largest_weight = 1;     // of a corner, in absolute value: more than 1 lifts the motion of that corner
};

// Reads the surface, which lies where pose 0 is, and embeds it. It is only drawn: parts, borders, seams and vertices without a face
// are fine. Throws Failure: P1209 the poses are no solid, what read_mesh throws, P2606 a vertex far outside the solid, P2608 not a
// surface with area. Warning: P2607 vertices outside the solid.
DrawnSurface load_drawn_surface(const std::string& path, const PoseSet& poses, std::vector<Finding>* warnings = nullptr);

// The same for a mesh in memory, as read_mesh leaves one.
DrawnSurface embed_surface(MeshFile mesh, const PoseSet& poses, std::vector<Finding>* warnings = nullptr);

// Vertices that each lie exactly where vertex `places[v]` of the elastic mesh does.
std::shared_ptr<const DrawnSurface> draw_vertices(Polygons polygons, std::vector<Triangle> triangles,
                                                  const std::vector<std::uint32_t>& places);

// The shapes of the surface in the poses of the solid, to measure its blends by: in the solid's units, around its origin. It has no
// elements; fixed_vertices are the solid's, and say only whether shapes are held.
ShapeSet drawn_shapes(const ShapeSet& solid, const DrawnSurface& surface);

// Where the vertices of the surface are when those that they hang on are at `positions`.
Positions drawn_positions(const DrawnSurface& surface, const Positions& positions);

} // namespace pliant
