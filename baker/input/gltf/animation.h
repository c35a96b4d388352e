// Animations of glTF: what nodes and morph weights do over time.
#pragma once

#include "input/gltf/scene.h"

#include <algorithm>

namespace pliant {

// Names of the file's animations, in order; empty where one has none.
std::vector<std::string> animation_names(const GltfDocument& document);

// Keys are in single precision, and people write times with few digits.
inline double time_slack(double seconds) { return 1e-6 * std::max(1.0, seconds); }

// The state of the scene at a time in seconds, from the state at rest: step, linear (the shorter way round for rotations)
// and cubic spline. Before the first key and after the last the value stays. A key that is at most time_slack() after the
// time counts as reached. What is read is taken from `allowance`. Throws Failure: P2326 (channels or samplers that make no
// sense), P2306 to P2311, P2333.
GltfState animated_state(const GltfScene& scene, std::size_t animation, double seconds, GltfAllowance& allowance);

// Seconds of the last key. Takes the times that it reads from `allowance`.
double animation_end(const GltfDocument& document, std::size_t animation, GltfAllowance& allowance);

} // namespace pliant
