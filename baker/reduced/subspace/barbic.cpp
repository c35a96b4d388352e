#include "reduced/subspace/barbic.h"

#include "elastic/average/rigid_modes.h"
#include "reduced/subspace/tangents.h"

#include <Eigen/Dense>
#include <algorithm>
#include <fmt/core.h>
#include <random>

namespace pliant {

namespace {

// A block that contains a part of every mode: noise, which the first solve smooths.
Eigen::MatrixXd start_block(Eigen::Index rows, Eigen::Index columns)
{
    std::mt19937_64 engine(1); // the standard fixes its numbers, so that bakes are reproducible
    Eigen::MatrixXd block(rows, columns);
    for (Eigen::Index i = 0; i < block.size(); ++i) block.data()[i] = double(engine() >> 11) * 0x1p-53 - 0.5;
    return block;
}

// Modes may come as clusters (a symmetric body has pairs of equal ones); the wanted ones converge by the gap to the first
// one beyond the block, so it is wider than what is wanted. Bathe's choice.
Eigen::Index block_size(Eigen::Index count, Eigen::Index dof_count)
{
    return std::min(std::max(2 * count, count + 8), dof_count - 6);
}

double largest_residual(const Eigen::MatrixXd& off, const LinearModes& modes, const Eigen::VectorXd& masses)
{
    double largest = 0;
    for (Eigen::Index j = 0; j < modes.eigenvalues.size(); ++j)
        largest = std::max(largest, mass_norm(off.col(j), masses) / modes.eigenvalues[j]);
    return largest;
}

} // namespace

LinearModes linear_modes(const NewtonSolver& solver, Eigen::Index count, double tolerance)
{
    // Each iteration multiplies what is wrong with mode j by lambda_j / lambda_(block + 1): six digits even where that is
    // 0.8.
    constexpr int iteration_limit = 60;
    const Eigen::VectorXd& masses = solver.set().masses;
    const Eigen::Index dof_count = solver.set().dof_count();
    LinearModes modes;
    count = std::min(count, dof_count - 6);
    if (count <= 0) return modes;
    Eigen::MatrixXd block = start_block(dof_count, block_size(count, dof_count));
    while (modes.iterations < iteration_limit) {
        ++modes.iterations;
        const Eigen::MatrixXd load = times_mass(block, masses), next = solver.solve_equilibrium(load);
        // Stiffness and mass in the span of `next`: K next = load, so that K itself is not needed.
        const Eigen::MatrixXd stiffness = next.transpose() * load, mass = next.transpose() * times_mass(next, masses);
        const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(0.5 * (stiffness + stiffness.transpose()),
                                                                             mass);
        // K (next * Z) = M (block * Z), but for rigid parts at the start
        const Eigen::MatrixXd kept = block * ritz.eigenvectors();
        block = next * ritz.eigenvectors();
        modes.vectors = block.leftCols(count);
        modes.eigenvalues = ritz.eigenvalues().head(count);
        if (modes.iterations == 1) continue; // the noise still had rigid parts
        // K x - lambda M x = M (kept - lambda x), whose norm in M^-1 is the mass norm of the bracket; x has mass norm 1.
        modes.residual
            = largest_residual(kept.leftCols(count) - modes.vectors * modes.eigenvalues.asDiagonal(), modes, masses);
        if (modes.residual <= tolerance) break;
    }
    return modes;
}

Subspace build_barbic_subspace(NewtonSolver& solver, const BarbicOptions& options, Progress* progress)
{
    const Eigen::Index m = Eigen::Index(solver.set().pose_count()), pair_count = m * (m - 1);
    Eigen::Index mode_count = options.mode_count;
    if (options.dimension > 0) {
        const Eigen::Index wanted = options.dimension - (m - 1) - pair_count;
        mode_count = std::max<Eigen::Index>(0, (wanted + m - 1) / m);
    }
    const Eigen::Index dof_count = solver.set().dof_count();
    mode_count = std::min(mode_count, dof_count - 6); // of a tiny mesh all modes may be asked for
    Eigen::MatrixXd all(dof_count, pair_count + mode_count * m);
    for (Eigen::Index k = 0; k < m; ++k) {
        if (progress) progress->update("subspace", double(k) / double(m), fmt::format("pose {} of {}", k + 1, m));
        all.middleCols(k * (m - 1), m - 1) = tangents_at_pose(solver, std::size_t(k));
        // Three digits: a basis does not profit from more.
        const LinearModes modes = linear_modes(solver, mode_count, 1e-3);
        if (mode_count > 0) all.middleCols(pair_count + k * mode_count, mode_count) = modes.vectors;
    }
    if (progress) progress->update("subspace", 0.95, "singular values");
    return build_subspace(solver.set(), all, options.dimension > 0 ? options.dimension : options.max_dimension);
}

} // namespace pliant
