#include "reduced/subspace/barbic.h"

#include "elastic/average/rigid_modes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <fmt/core.h>
#include <random>
#include <utility>
#include <vector>

namespace pliant {

namespace {

// Of a mode of unit mass norm, for second differences of forces: their rounding is 1e-8 of them.
constexpr double difference_step = 1e-4;

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
    const Eigen::Index dof_count = solver.set().dof_count(); // of a tiny mesh all modes may be asked for
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

Eigen::MatrixXd modal_derivatives(const NewtonSolver& solver, std::size_t k, const Eigen::MatrixXd& modes)
{
    const Shape& pose = solver.set().shapes[k];
    const Weights w = corner_weights(solver.set().pose_count(), k);
    const auto force = [&](const Shape& step) {
        Shape gradient = Shape::Zero(step.size());
        add_gradient(solver.energy(), w, pose + difference_step * step, gradient);
        return gradient;
    };
    const Eigen::Index count = modes.cols();
    Eigen::MatrixXd loads(modes.rows(), count * (count + 1) / 2);
    for (Eigen::Index j = 0, column = 0; j < count; ++j)
        for (Eigen::Index i = 0; i <= j; ++i) {
            const Shape sum = modes.col(i) + modes.col(j), difference = modes.col(i) - modes.col(j);
            loads.col(column++) = force(sum) + force(-sum) - force(difference) - force(-difference);
        }
    return solver.solve_equilibrium(loads / (-4 * difference_step * difference_step));
}

namespace {

// Tangents of the deformation curves from pose 0 to the others at their ends, then at pose 0, where the solver is left
// factored.
Eigen::MatrixXd curve_tangents(NewtonSolver& solver, Progress* progress)
{
    const std::size_t m = solver.set().pose_count();
    const Weights w = corner_weights(m, 0);
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(solver.set().dof_count(), Eigen::Index(m) - 1), at_poses = loads;
    for (std::size_t k = 1; k < m; ++k) {
        if (progress) progress->update("subspace", double(k) / double(m + 1), fmt::format("pose {} of {}", k + 1, m));
        const Shape& pose = solver.set().shapes[k];
        const Eigen::Index column = Eigen::Index(k) - 1;
        Shape force = Shape::Zero(pose.size());
        add_gradient(solver.energy(), w, pose, force);
        loads.col(column) = force;
        solver.factorize_equilibrium(w, pose);
        at_poses.col(column) = solver.solve_equilibrium(force);
    }
    solver.factorize_equilibrium(w, solver.set().shapes[0]);
    Eigen::MatrixXd tangents(loads.rows(), 2 * loads.cols());
    tangents << at_poses, solver.solve_equilibrium(loads);
    return tangents;
}

// Modes and derivatives in the order of how far they reach at low frequencies: the weights lambda_0 / lambda_i and
// lambda_0^2 / (lambda_i lambda_j) of Barbic and James 2005.
Eigen::MatrixXd by_frequency(const LinearModes& modes, const Eigen::MatrixXd& derivatives)
{
    std::vector<std::pair<double, Shape>> vectors;
    const Eigen::VectorXd reach = modes.eigenvalues.cwiseInverse() * modes.eigenvalues[0];
    for (Eigen::Index j = 0, column = 0; j < reach.size(); ++j) {
        vectors.emplace_back(reach[j], modes.vectors.col(j));
        for (Eigen::Index i = 0; i <= j; ++i) vectors.emplace_back(reach[i] * reach[j], derivatives.col(column++));
    }
    std::stable_sort(vectors.begin(), vectors.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    Eigen::MatrixXd ordered(modes.vectors.rows(), Eigen::Index(vectors.size()));
    for (std::size_t i = 0; i < vectors.size(); ++i) ordered.col(Eigen::Index(i)) = vectors[i].second;
    return ordered;
}

} // namespace

Subspace build_barbic_subspace(NewtonSolver& solver, const BarbicOptions& options, Progress* progress)
{
    const Eigen::MatrixXd tangents = curve_tangents(solver, progress);
    const Eigen::Index m = Eigen::Index(solver.set().pose_count()), dof_count = solver.set().dof_count();
    const Eigen::Index wanted = std::max<Eigen::Index>(0, options.dimension - (m - 1) - tangents.cols());
    Eigen::Index mode_count = options.dimension > 0 ? 0 : options.mode_count;
    while (mode_count * (mode_count + 3) / 2 < wanted) ++mode_count;
    // Three digits: a basis does not profit from more.
    const LinearModes modes = linear_modes(solver, mode_count, 1e-3);
    Eigen::MatrixXd all(dof_count, tangents.cols());
    all << tangents;
    if (modes.vectors.cols() > 0) {
        const Eigen::MatrixXd ordered = by_frequency(modes, modal_derivatives(solver, 0, modes.vectors));
        const Eigen::Index count = options.dimension > 0 ? std::min(wanted, ordered.cols()) : ordered.cols();
        all.conservativeResize(dof_count, tangents.cols() + count);
        all.rightCols(count) = ordered.leftCols(count);
    }
    if (progress) progress->update("subspace", 0.95, "singular values");
    return build_subspace(solver.set(), all, options.dimension > 0 ? options.dimension : options.max_dimension);
}

} // namespace pliant
