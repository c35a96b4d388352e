#include "reduced/subspace/krylov.h"

#include "base/mesh/tets.h"
#include "elastic/average/rigid_modes.h"
#include "reduced/subspace/tangents.h"

#include <fmt/core.h>

namespace pliant {

namespace {

// Scales every column to unit mass norm; a zero column stays zero (pose j may be in balance at pose k).
void normalise_columns(Eigen::MatrixXd& x, const Eigen::VectorXd& masses)
{
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
        const double norm = mass_norm(x.col(j), masses);
        if (norm > 0) x.col(j) /= norm;
    }
}

// All x_j - x_k but j = k, without rigid motions of pose k, at which the solver is left factored.
Eigen::MatrixXd differences_at_pose(NewtonSolver& solver, std::size_t k)
{
    const NormalizedPoses& set = solver.set();
    Eigen::MatrixXd out(set.dof_count(), Eigen::Index(set.pose_count()) - 1);
    for (std::size_t j = 0; j < set.pose_count(); ++j)
        if (j != k) out.col(Eigen::Index(j < k ? j : j - 1)) = set.shapes[j] - set.shapes[k];
    if (set.is_free()) remove_rigid_motion(out, rigid_modes(set.shapes[k], set.masses), set.masses);
    solver.factorize_equilibrium(corner_weights(set.pose_count(), k), set.shapes[k]);
    return out;
}

// The start vectors at pose k, if they are tangents, then for each of them ritz_count Lanczos vectors of K^-1 M: three-term
// recurrence, all of them side by side so that every solve has m - 1 right-hand sides.
std::vector<Eigen::MatrixXd> vectors_at_pose(NewtonSolver& solver, std::size_t k, int ritz_count, KrylovStart start)
{
    const Eigen::VectorXd masses = cell_masses(solver.set(), solver.set().shapes[k]);
    const bool has_tangents = start == KrylovStart::tangents;
    std::vector<Eigen::MatrixXd> out;
    Eigen::MatrixXd current = has_tangents ? tangents_at_pose(solver, k) : differences_at_pose(solver, k), previous;
    normalise_columns(current, masses);
    Eigen::VectorXd beta = Eigen::VectorXd::Zero(current.cols());
    if (has_tangents) out.push_back(current);
    for (int i = 0; i < ritz_count; ++i) {
        Eigen::MatrixXd next = solver.solve_equilibrium(times_mass(current, masses));
        for (Eigen::Index j = 0; j < next.cols(); ++j) {
            next.col(j) -= mass_dot(next.col(j), current.col(j), masses) * current.col(j);
            if (i > 0) next.col(j) -= beta[j] * previous.col(j);
            beta[j] = mass_norm(next.col(j), masses);
        }
        normalise_columns(next, masses);
        previous = current;
        current = next;
        out.push_back(current);
    }
    return out;
}

} // namespace

Subspace build_krylov_subspace(NewtonSolver& solver, const KrylovOptions& options, Progress* progress)
{
    const Eigen::Index m = Eigen::Index(solver.set().pose_count());
    const int start_count = options.start == KrylovStart::tangents ? 1 : 0;
    int ritz_count = options.ritz_count;
    if (options.dimension > 0) {
        const Eigen::Index per_step = m * (m - 1), wanted = options.dimension - (m - 1) - start_count * per_step;
        ritz_count = int(std::max<Eigen::Index>(0, (wanted + per_step - 1) / per_step));
    }
    // All tangents first, then all first Ritz vectors, and so on: should rounding make two of them equal, the more important
    // one stays.
    std::vector<Eigen::MatrixXd> levels(std::size_t(ritz_count + start_count));
    for (Eigen::Index k = 0; k < m; ++k) {
        if (progress) progress->update("subspace", double(k) / double(m), fmt::format("pose {} of {}", k + 1, m));
        const auto vectors = vectors_at_pose(solver, std::size_t(k), ritz_count, options.start);
        for (std::size_t level = 0; level < levels.size(); ++level) {
            levels[level].conservativeResize(solver.set().dof_count(), levels[level].cols() + m - 1);
            levels[level].rightCols(m - 1) = vectors[level];
        }
    }
    Eigen::MatrixXd all(solver.set().dof_count(), Eigen::Index(levels.size()) * m * (m - 1));
    for (std::size_t level = 0; level < levels.size(); ++level)
        all.middleCols(Eigen::Index(level) * m * (m - 1), m * (m - 1)) = levels[level];
    if (progress) progress->update("subspace", 0.95, "singular values");
    return build_subspace(solver.set(), all, options.dimension > 0 ? options.dimension : options.max_dimension);
}

} // namespace pliant
