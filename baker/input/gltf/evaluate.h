// The shape of a glTF scene in a state of its nodes and morph weights.
#pragma once

#include "input/gltf/scene.h"

namespace pliant {

// Positions of all vertices, instance after instance, primitive after primitive: morph targets first, then the skin (joints
// times inverse bind matrices; the node's own place does not count) or the place of the node in the world. In the file's
// units and axes.
// `normals`: if not null, gets the normals in the same order; zero where a primitive has none.
// Throws Failure: P2317 and what read_numbers throws, for morph targets.
Positions evaluate(const GltfScene& scene, const GltfState& state, Positions* normals = nullptr);

// Of the coarsest grid that a primitive's positions were rounded to, in the file's units, with what weights of morph targets
// and the places of nodes and joints make of it; 0: of none.
double position_step(const GltfScene& scene, const GltfState& state);

// Triangles of the same, with the numbers of those rows; turned round in mirrored instances, so that the outside stays
// outside.
std::vector<Triangle> triangles_of(const GltfScene& scene);

} // namespace pliant
