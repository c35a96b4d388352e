// The rotation of the polar decomposition.
#pragma once

#include <Eigen/Core>

namespace pliant {

// The proper rotation R that maximises tr(R^T M). If the maximum is not unique, one of them. Cost: a few hundred
// operations; where the maximum is nearly not unique, a singular value decomposition.
Eigen::Matrix3d best_rotation(const Eigen::Matrix3d& m);

} // namespace pliant
