// The subspaces that are made of vectors at the poses: Algorithm 1 of the paper; linear modes, and the subspace of Barbic
// et al. 2009 that is made of them.
#include "../tube.h"

#include "base/mesh/tets.h"
#include "elastic/average/hessian.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/energy/discrete_shells.h"
#include "reduced/subspace/barbic.h"
#include "reduced/subspace/krylov.h"
#include "reduced/subspace/tangents.h"

#include <Eigen/Dense>
#include <cmath>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

struct Problem {
    Problem(std::size_t pose_count, const Tube& tube)
        : set(normalize(tube_poses(pose_count, tube)))
        , energy(set, ShellOptions())
        , solver(energy, set, default_solver())
    {
    }
    LinearModes modes_of_pose(std::size_t k, Eigen::Index count, double tolerance)
    {
        solver.factorize_equilibrium(corner_weights(set.pose_count(), k), set.shapes[k]);
        return linear_modes(solver, count, tolerance);
    }
    Eigen::MatrixXd stiffness(std::size_t k) const { return stiffness(set.shapes[k], k); }
    Eigen::MatrixXd stiffness(const Shape& y, std::size_t k = 0) const
    {
        HessianAssembler assembler(energy);
        assembler.assemble(corner_weights(set.pose_count(), k), y, HessianKind::exact);
        return Eigen::MatrixXd(assembler.matrix()).selfadjointView<Eigen::Lower>();
    }
    Eigen::VectorXd mass_diagonal() const
    {
        Eigen::VectorXd diagonal(set.dof_count());
        for (Eigen::Index i = 0; i < diagonal.size(); ++i) diagonal[i] = set.masses[i / 3];
        return diagonal;
    }
    NormalizedPoses set;
    DiscreteShells energy;
    NewtonSolver solver;
};

const Tube small_tube { 9, 6 };

// What a projection onto the subspace's directions leaves of a vector, over its size.
double left_over(const Subspace& subspace, const Shape& vector, const Eigen::VectorXd& masses)
{
    const Shape left = vector - subspace.basis * (subspace.basis.transpose() * times_mass(vector, masses));
    return mass_norm(left, masses) / mass_norm(vector, masses);
}

} // namespace

TEST_CASE("linear modes satisfy K x = lambda M x, are mass-orthonormal and hold no rigid motion")
{
    Problem p(2, small_tube);
    for (std::size_t k = 0; k < 2; ++k) {
        const LinearModes modes = p.modes_of_pose(k, 7, 1e-8);
        CHECK(modes.residual <= 1e-8);
        const Eigen::MatrixXd& x = modes.vectors;
        const Eigen::VectorXd mass = p.mass_diagonal();
        // In the norm of M^-1, as the residual is defined. K has eigenvalues a million times as large as these, so that
        // rounding of the factorisation shows here.
        const Eigen::MatrixXd stiffness = p.stiffness(k);
        const Eigen::MatrixXd off = stiffness * x - mass.asDiagonal() * x * modes.eigenvalues.asDiagonal();
        for (Eigen::Index j = 0; j < x.cols(); ++j)
            CHECK(mass.cwiseSqrt().cwiseInverse().cwiseProduct(off.col(j)).norm() < 1e-6 * modes.eigenvalues[j]);
        CHECK((x.transpose() * mass.asDiagonal() * x - Eigen::MatrixXd::Identity(7, 7)).norm() < 1e-10);
        CHECK((rigid_modes(p.set.shapes[k], p.set.masses).transpose() * mass.asDiagonal() * x).norm() < 1e-10);
        // A mode of the other pose is none of this one.
        const LinearModes other = p.modes_of_pose(1 - k, 1, 1e-8);
        const Shape wrong = stiffness * other.vectors - other.eigenvalues[0] * mass.asDiagonal() * other.vectors;
        CHECK(mass.cwiseSqrt().cwiseInverse().cwiseProduct(wrong).norm() > other.eigenvalues[0]);
    }
}

TEST_CASE("linear modes are the softest ones: eigenvalues of the dense problem, behind its six zeros")
{
    Problem p(2, small_tube);
    const LinearModes modes = p.modes_of_pose(1, 7, 1e-8);
    const Eigen::MatrixXd mass = p.mass_diagonal().asDiagonal();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(p.stiffness(1), mass, Eigen::EigenvaluesOnly);
    CHECK(dense.eigenvalues().head(6).cwiseAbs().maxCoeff() < 1e-6 * dense.eigenvalues()[6]);
    for (Eigen::Index j = 0; j < 7; ++j)
        CHECK(modes.eigenvalues[j] == doctest::Approx(dense.eigenvalues()[6 + j]).epsilon(1e-7));
}

TEST_CASE("all modes of a tiny mesh: as many as there are degrees of freedom beside rigid motions")
{
    Problem p(2, Tube { 2, 3 }); // 8 vertices
    const LinearModes modes = p.modes_of_pose(0, 100, 1e-6);
    CHECK(modes.vectors.cols() == 18);
    CHECK(p.modes_of_pose(0, 0, 1e-6).vectors.cols() == 0);
}

TEST_CASE("modal derivatives: how the stiffness changes along one mode, felt along another")
{
    Problem p(2, small_tube);
    const LinearModes modes = p.modes_of_pose(0, 3, 1e-8);
    const Eigen::MatrixXd derivatives = modal_derivatives(p.solver, 0, modes.vectors),
                          stiffness = p.stiffness(p.set.shapes[0]);
    CHECK(derivatives.cols() == 6);
    const double step = 1e-4;
    for (Eigen::Index j = 0, column = 0; j < 3; ++j) {
        const Shape move = step * modes.vectors.col(j);
        const Eigen::MatrixXd change
            = (p.stiffness(p.set.shapes[0] + move) - p.stiffness(p.set.shapes[0] - move)) / (2 * step);
        for (Eigen::Index i = 0; i <= j; ++i, ++column) {
            Eigen::MatrixXd load = -change * modes.vectors.col(i);
            balance_load(load, rigid_modes(p.set.shapes[0], p.set.masses), p.set.masses);
            CHECK((stiffness * derivatives.col(column) - load).norm() < 1e-4 * load.norm());
        }
    }
}

TEST_CASE("the subspace holds poses, tangents of one object's curves, modes and their derivatives")
{
    Problem p(3, small_tube);
    const Subspace subspace = build_barbic_subspace(p.solver, { 2, 0, 256 }, nullptr);
    CHECK(subspace.dimension() == 2 + 4 + 2 + 3);
    const Eigen::MatrixXd gram = subspace.basis.transpose() * times_mass(subspace.basis, p.set.masses);
    CHECK((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).norm() < 1e-12);
    for (std::size_t k = 0; k < 3; ++k)
        CHECK((subspace.shape(subspace.pose_coordinates.col(Eigen::Index(k))) - p.set.shapes[k]).norm() < 1e-12);
    // The curve of statics of pose 0 under the loads of pose 1 starts along a direction of the space.
    Shape load = Shape::Zero(p.set.dof_count());
    add_gradient(p.energy, corner_weights(3, 0), p.set.shapes[1], load);
    p.solver.factorize_equilibrium(corner_weights(3, 0), p.set.shapes[0]);
    CHECK(left_over(subspace, p.solver.solve_equilibrium(load), p.set.masses) < 1e-9);
    const LinearModes modes = linear_modes(p.solver, 3, 1e-6);
    const Eigen::MatrixXd derivatives = modal_derivatives(p.solver, 0, modes.vectors);
    // The baker stops the iteration at three digits; the third mode and its derivatives were not asked for.
    for (Eigen::Index j = 0; j < 2; ++j) CHECK(left_over(subspace, modes.vectors.col(j), p.set.masses) < 1e-2);
    for (Eigen::Index j = 0; j < 3; ++j) CHECK(left_over(subspace, derivatives.col(j), p.set.masses) < 1e-2);
    CHECK(left_over(subspace, modes.vectors.col(2), p.set.masses) > 0.1);
    CHECK(left_over(subspace, tangents_at_pose(p.solver, 1).col(0), p.set.masses) > 0.01); // those of averages
    for (Eigen::Index d : { 3, 6, 7, 9, 15 })
        CHECK(build_barbic_subspace(p.solver, { 0, d, 256 }, nullptr).dimension() == d);
}

TEST_CASE("the subspace of Algorithm 1 holds the Krylov spaces of its start vectors, and no more of them")
{
    Problem p(2, Tube());
    for (const bool has_tangents : { true, false }) {
        const KrylovStart start = has_tangents ? KrylovStart::tangents : KrylovStart::differences;
        const Subspace subspace = build_krylov_subspace(p.solver, { 2, 0, 256, start }, nullptr);
        CHECK(subspace.dimension() == (has_tangents ? 1 + 2 * 3 : 1 + 2 * 2));
        for (std::size_t k = 0; k < 2; ++k) {
            Shape vector = tangents_at_pose(p.solver, k).col(0); // leaves the factor of K_k
            if (!has_tangents) vector = p.set.shapes[1 - k] - p.set.shapes[k];
            remove_rigid_motion(vector, rigid_modes(p.set.shapes[k], p.set.masses), p.set.masses);
            const Eigen::VectorXd masses = cell_masses(p.set, p.set.shapes[k]);
            for (int i = has_tangents ? 0 : 1; i <= 3; ++i) {
                if (i > 0) vector = p.solver.solve_equilibrium(times_mass(vector, masses));
                const double left = left_over(subspace, vector, p.set.masses);
                CHECK((i <= 2 ? left < 1e-7 : left > 1e-6));
            }
        }
    }
}

TEST_CASE("rounding in the vectors moves no fixed vertex")
{
    PoseSet poses = tube_poses(2, small_tube);
    poses.fixed_vertices = { 0, 1, 2, 3, 4, 5 };
    for (std::uint32_t v : poses.fixed_vertices) poses.positions[1].row(v) = poses.positions[0].row(v);
    const NormalizedPoses set = normalize(poses);
    Eigen::MatrixXd vectors(set.dof_count(), 1);
    for (Eigen::Index i = 0; i < vectors.size(); ++i) vectors(i) = i < 18 ? 1e-16 * double(i) : std::sin(double(i));
    const Subspace subspace = build_subspace(set, vectors, 4);
    REQUIRE(subspace.dimension() == 2);
    CHECK(subspace.basis.topRows(18).isZero(0));
}
