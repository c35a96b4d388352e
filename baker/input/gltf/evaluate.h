// The shape of a glTF scene in a state of its nodes and morph weights.
#pragma once

#include "input/gltf/scene.h"

namespace pliant {

// Positions of all vertices, instance after instance, primitive after primitive: morph targets first, then the skin (joints
// times inverse bind matrices; the node's own place does not count) or the place of the node in the world. In the file's
// units and axes.
// `normals`: if not null, gets the normals in the same order; zero where a primitive has none. The numbers of morph targets
// are taken from `allowance`.
// Throws Failure: P2317, P2333 and what read_numbers throws, for morph targets.
Positions evaluate(const GltfScene& scene, const GltfState& state, GltfAllowance& allowance, Positions* normals = nullptr);

// Steps of the grids that positions were rounded to, instance after instance, primitive after primitive, in the units of the
// file, with what weights of morph targets and the places of nodes and joints make of them; 0: not rounded. Empty: none is.
std::vector<double> position_steps(const GltfScene& scene, const GltfState& state, GltfAllowance& allowance);

// Triangles of the same, with the numbers of those rows; turned round in mirrored instances, so that the outside stays
// outside.
std::vector<Triangle> triangles_of(const GltfScene& scene);

} // namespace pliant
