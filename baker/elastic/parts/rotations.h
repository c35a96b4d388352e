// Rotations between point clouds, and the pivot of a moving body.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

// The proper rotation that brings the points `from` (3 x n) closest to the points `to` (3 x n), both taken about their
// centroids (Kabsch 1976).
Eigen::Matrix3d best_rotation(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

// The proper rotation nearest to a matrix in the Frobenius norm. For a weighted mean of rotations this is the chordal mean
// (Hartley et al. 2013, Rotation averaging).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

// The largest angle between two of them (radians).
double largest_rotation(const std::vector<Eigen::Matrix3d>& rotations);

// The point of a body that moves least over the poses, in the body's coordinates: the point j that minimizes the variance of
// rotations[k] j + centres.col(k), where centres (3 x m) are the positions of the body's origin. A regularisation draws j to
// the origin; it dominates below rotations of about 10 degrees, where all points move alike and the choice matters little.
// |j| is at most `reach`.
Eigen::Vector3d pivot_point(const std::vector<Eigen::Matrix3d>& rotations, const Eigen::Matrix3Xd& centres, double reach);

} // namespace pliant
