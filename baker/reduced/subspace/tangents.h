// Tangents of the curves of averages at the poses.
#pragma once

#include "elastic/average/newton.h"

namespace pliant {

// For every other pose j the tangent K_k w = grad W_j(x_k) of the curve of averages of poses k and j at x_k (von Tycowicz et
// al. 2015, equation 6; the sign does not matter for a basis), free of rigid motions, side by side (3n x (m - 1)). Leaves
// the solver factored at pose k, so that solve_equilibrium can go on with K_k.
Eigen::MatrixXd tangents_at_pose(NewtonSolver& solver, std::size_t k);

} // namespace pliant
