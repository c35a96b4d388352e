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

// The rows of a part out of `width` numbers for each vertex.
std::vector<float> rows_of(const ScenePart& part, const std::vector<float>& values, std::size_t width);

// One primitive a part, in their order: POSITION (bounded), NORMAL, indices, texture coordinates, colours, material.
// Positions and normals (3n) are those of all vertices. With compression positions, normals and faces are in Draco's form;
// fills in what the report has of it.
Glb::Json add_primitives(Glb& glb, const RenderScene& scene, const std::vector<float>& positions,
                         const std::vector<float>& normals, const ExportOptions& options, ExportReport& report);

// Materials, textures, samplers, images and the extensions that they use. Images that the embedded asset holds are not
// stored again.
void add_materials(Glb& glb, const RenderScene& scene);

} // namespace pliant
