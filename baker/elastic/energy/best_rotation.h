// The rotation of the polar decomposition.
#pragma once

#include <Eigen/Core>

namespace pliant {

// The proper rotation R that maximises tr(R^T M). Where several do, one of them. Cost: a quarter of a microsecond; where the
// largest two sums of singular values are equal to some digits, a few of them.
Eigen::Matrix3d best_rotation(const Eigen::Matrix3d& m);

} // namespace pliant
