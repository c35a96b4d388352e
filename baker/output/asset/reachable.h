// Where the coordinates of an asset can go: what its morph targets, their normals and bones are fitted to.
#pragma once

#include "output/asset/runtime_blender.h"

#include <Eigen/Core>
#include <vector>

namespace pliant {

// The coordinates that the runtime finds for the weights, each as from a new solver: d x weights.
Eigen::MatrixXf blend_coordinates(RuntimeBlender& blender, const std::vector<std::vector<float>>& weights);

// What MRNG holds: q maps to morph weights by (q - low) / (high - low).
struct MorphRanges {
    Eigen::VectorXf low, high;
};

// Least and largest of each coordinate over the columns, with `margin` of the width added on both sides.
MorphRanges ranges_of(const Eigen::MatrixXf& coordinates, float margin);

// Of 2,000 mixed weights, the poses with their mean, and the ways between these, followed as an animation is; with a margin
// of 5 %. Cost: as many solves, below a second.
MorphRanges find_morph_ranges(RuntimeBlender& blender);

// The ranges in the asset; null if it has none.
const float* stored_morph_ranges(const RuntimeBlender& blender);

} // namespace pliant
