// Dihedral angle of a hinge with its first and second derivatives.
#pragma once

#include <Eigen/Core>

namespace pliant {

using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

// Signed angle between the two faces at the edge x0 x1, with x2 opposite in the first face and x3 in the second; 0 when
// flat, in (-pi, pi]. With e = x1 - x0, a = x2 - x0, b = x3 - x0, N1 = e x a, N2 = b x e:
//     theta = atan2(e . (N1 x N2) / |e|, N1 . N2).
double hinge_angle(const Eigen::Vector3d& x0, const Eigen::Vector3d& x1, const Eigen::Vector3d& x2,
                   const Eigen::Vector3d& x3);

// The same with derivatives with respect to (x0, x1, x2, x3); either pointer may be null. Needs faces with area.
double hinge_angle(const Eigen::Vector3d& x0, const Eigen::Vector3d& x1, const Eigen::Vector3d& x2,
                   const Eigen::Vector3d& x3, Vector12* gradient, Matrix12* hessian);

} // namespace pliant
