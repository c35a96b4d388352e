// Rotations of clouds of points, and what they turn about.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

// The turn of a cloud of points, columns of `from`, that brings it closest to another one (Kabsch 1976), centroids aside.
Eigen::Matrix3d best_rotation(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

// The rotation nearest to a matrix: of a mean of rotations their mean.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

// The point of a body that moves least over its poses, where it is attached: the j that minimises the variance of turns_k j + centres_k
// (rotations of the poses, and where the body's origin is in them). Where the body hardly rotations, below some 10 degrees, all points move alike
// and it is drawn to the origin; there it matters little. No farther than `reach` from there.
Eigen::Vector3d pivot_point(const std::vector<Eigen::Matrix3d>& rotations, const Eigen::Matrix3Xd& centres, double reach);

} // namespace pliant
