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

// Tangents at pose k, then for each of them ritz_count Lanczos vectors of K^-1 M: three-term recurrence, all tangents side
// by side so that every solve has m - 1 right-hand sides.
std::vector<Eigen::MatrixXd> vectors_at_pose(NewtonSolver& solver, std::size_t k, int ritz_count)
{
    const Eigen::VectorXd masses = cell_masses(solver.set(), solver.set().shapes[k]);
    std::vector<Eigen::MatrixXd> out;
    Eigen::MatrixXd current = tangents_at_pose(solver, k), previous;
    normalise_columns(current, masses);
    Eigen::VectorXd beta = Eigen::VectorXd::Zero(current.cols());
    out.push_back(current);
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
    int ritz_count = options.ritz_count;
    if (options.dimension > 0) {
        const Eigen::Index per_step = m * (m - 1), wanted = options.dimension - (m - 1) - per_step;
        ritz_count = int(std::max<Eigen::Index>(0, (wanted + per_step - 1) / per_step));
    }
    // All tangents first, then all first Ritz vectors, and so on: should rounding make two of them equal, the more important
    // one stays.
    std::vector<Eigen::MatrixXd> levels(std::size_t(ritz_count) + 1);
    for (Eigen::Index k = 0; k < m; ++k) {
        if (progress) progress->update("subspace", double(k) / double(m), fmt::format("pose {} of {}", k + 1, m));
        const auto vectors = vectors_at_pose(solver, std::size_t(k), ritz_count);
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
