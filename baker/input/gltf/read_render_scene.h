// From a glTF scene to what is kept of it for drawing.
#pragma once

#include "input/gltf/render_scene.h"
#include "input/gltf/scene.h"

namespace pliant {

// `normals`: of the state that the first pose is in (evaluate). Images that cannot be had are left out, and so are the
// textures that need them: warning P2328. Throws Failure for materials, textures or images that are not what glTF says
// (P2306, P2307).
RenderScene render_scene(const GltfScene& scene, const Positions& normals, std::vector<Diagnostic>& warnings);

// Every index in the lists that are kept (materials, textures, samplers) points into them. Throws Failure: P2306, P2307.
void check_materials(const GltfDocument& document);

// Adds to `materials` the extensions that its objects use and, of these, the ones that the document requires.
void list_extensions(const GltfDocument& document, GltfJson& materials);

} // namespace pliant
