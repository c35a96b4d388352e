// The primitives of an exported mesh: one for each part of the asset's scene, with its attributes and material.
#pragma once

#include "input/gltf/render_scene.h"
#include "output/export/export_options.h"
#include "output/export/glb.h"
#include "output/export/morph_mesh.h"

namespace pliant {

// What the drawn vertices are drawn with: the asset's chunk GLTF, else one part of all in plain grey. Parts without faces
// are left out.
// `path` is for messages. Throws Failure (bad_input): P2301 to P2317 for a damaged chunk, P4505 for one of other vertices.
RenderScene exported_scene(const RuntimeBlender& blender, const DrawnSpace& space, const std::string& path);

// Positions and normals of all vertices (3n each), of a mesh or of a morph target, in the numbers that the file stores.
struct StoredVertices {
    Eigen::VectorXd positions, normals; // normals empty: none
    bool is_whole = false;              // positions become shorts or bytes, normals bytes of 1/127; else floats
};

// One primitive a part, in their order: POSITION (bounded), NORMAL, indices, texture coordinates, colours, material. With a
// `box` (two corners, as positions) each primitive has these as two more vertices, in a triangle without area: engines that
// compute its bounds from its vertices then find the box. The extras say how many vertices are the asset's.
Glb::Json add_primitives(Glb& glb, const RenderScene& scene, const StoredVertices& vertices, const Eigen::VectorXd& box);

// Adds a morph target to each of the primitives, which have a box; its vertices stay where they are.
void add_target(Glb& glb, const RenderScene& scene, const StoredVertices& deltas, Glb::Json& primitives);

// Materials, textures, samplers, images and the extensions that they use. Images that the embedded asset holds are not
// stored again.
void add_materials(Glb& glb, const RenderScene& scene);

} // namespace pliant
