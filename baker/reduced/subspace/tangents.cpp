#include "reduced/subspace/tangents.h"

namespace pliant {

Eigen::MatrixXd tangents_at_pose(NewtonSolver& solver, std::size_t k)
{
    const std::size_t m = solver.set().pose_count();
    const Shape& pose = solver.set().shapes[k];
    Eigen::MatrixXd loads(solver.set().dof_count(), Eigen::Index(m) - 1);
    Eigen::Index column = 0;
    for (std::size_t j = 0; j < m; ++j) {
        if (j == k) continue;
        Shape force = Shape::Zero(solver.set().dof_count());
        add_gradient(solver.energy(), corner_weights(m, j), pose, force);
        loads.col(column++) = force;
    }
    solver.factorize_equilibrium(corner_weights(m, k), pose);
    return solver.solve_equilibrium(loads);
}

} // namespace pliant
