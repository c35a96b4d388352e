// From poses as they came to the problem that is solved: rigidly aligned, centred, in units of the character.
#pragma once

#include "base/mesh/normalized_poses.h"

namespace pliant {

// The proper rigid motion that brings `from` closest to `to` in the sum of masses times squared distances (Kabsch 1976).
RigidMotion best_rigid_motion(const Shape& from, const Shape& to, const Eigen::VectorXd& masses);

double degrees_of(const RigidMotion& motion);

void apply(const RigidMotion& motion, Shape& shape);

// Moves `shape` rigidly to where it is closest to `target`, unless fixed vertices hold it.
void align_to(const NormalizedPoses& set, const Shape& target, Shape& shape);

// Turns displacements (columns) of an aligned shape such that it stays closest to `target`, unless fixed vertices hold it.
void keep_aligned(const NormalizedPoses& set, const Shape& target, const Shape& shape, Eigen::MatrixXd& displacements);

// Aligns (unless `keep_placement`, the poses share a frame, or vertices are fixed) and normalises. Poses that are turned by
// more than 75 degrees against their mean are aligned all the same: no blend of such turns depends continuously on weights.
NormalizedPoses normalize(const PoseSet& poses, bool keep_placement = false);

// By how much a pose was turned to align it with pose 0.
double turned_degrees(const NormalizedPoses& set, std::size_t pose);

// Back to input units and place.
Positions to_input_units(const NormalizedPoses& set, const Shape& shape);

// The inverse for positions as the runtime writes them (3n floats): a shape in normalized units.
Shape from_input_units(const NormalizedPoses& set, const std::vector<float>& positions);

} // namespace pliant
