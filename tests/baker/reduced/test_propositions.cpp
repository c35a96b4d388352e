// What the paper proves about elastic averages (von Tycowicz, Schulz, Seidel, Hildebrandt 2015, section 3), as tests: of the
// unreduced average and, where it holds there too, of the reduced one. Each case also shows what a violation would look
// like.
#include "../tube.h"

#include "bake/bake.h"
#include "elastic/average/family.h"
#include "elastic/average/shape_error.h"
#include "reduced/subspace/krylov.h"
#include "reduced/surrogate/training.h"

#include <Eigen/Dense>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

// A pose has energy 0: no relative decrease says that it is reached. Blends of the tube have some 1e-4.
constexpr double no_energy = 1e-18;

struct Problem {
    explicit Problem(const PoseSet& poses, bool keep_placement = false)
        : set(normalize(poses, keep_placement))
        , energy(set, ShellOptions())
        , solver(energy, set, default_solver())
    {
        tight.decrement = 1e-20; // quadratic convergence: the step after the last one would be rounding
        tight.residual = 1e-9;
    }

    Shape average(const Weights& w, std::size_t start = 0)
    {
        const NewtonResult result = solver.minimize(w, set.shapes[start], tight);
        CHECK((result.has_converged || result.energy < no_energy));
        return result.y;
    }
    Shape reduced_average(const Subspace& subspace, const Weights& w, std::size_t start = 0) const
    {
        const Eigen::VectorXd q = subspace.pose_coordinates.col(Eigen::Index(start));
        const MinimizeResult result = minimize_newton(ReducedEnergy(energy, subspace), w, q, 1e-10);
        CHECK((result.has_converged || result.value < no_energy));
        return subspace.shape(result.q);
    }

    NormalizedPoses set;
    DiscreteShells energy;
    NewtonSolver solver;
    NewtonOptions tight;
};

Weights weights3(double a, double b, double c)
{
    Weights w(3);
    w << a, b, c;
    return w;
}

RigidMotion some_motion(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& translation)
{
    return { Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), translation };
}

void move(Positions& positions, const RigidMotion& motion)
{
    positions = ((positions * motion.rotation.transpose()).rowwise() + motion.translation.transpose()).eval();
}

// The tubes, each pose turned (in all by `share` of what is here) and shifted by a motion of its own.
PoseSet scattered_tubes(double share = 1)
{
    PoseSet poses = tube_poses(3);
    move(poses.positions[0], some_motion(0.7 * share, { 1, 0, 2 }, { 3, 1, -2 }));
    move(poses.positions[1], some_motion(2.5 * share, { 1, 2, 3 }, { -8, 4, 1 }));
    move(poses.positions[2], some_motion(-1.1 * share, { 0, 1, 1 }, { 0, 0, 9 }));
    return poses;
}

// Relative L2 after rigid alignment: two ways to compute the same shape agree to `same` (1e-15 to 1.2e-12 were measured);
// shapes that break a proposition slightly are farther apart than `different`.
constexpr double same = 3e-12, different = 1e-5;

} // namespace

TEST_CASE("Lagrange property: all weight on one pose gives that pose, unreduced and reduced")
{
    Problem p(tube_poses(3));
    const Subspace subspace = build_krylov_subspace(p.solver, { 1, 0, 256 }, nullptr);
    SolverPool pool(p.energy, p.set, default_solver());
    AverageFamily family(pool, p.tight, nullptr);
    family.mean();
    for (std::size_t k = 0; k < 3; ++k) {
        const Weights corner = corner_weights(3, k);
        const Shape& pose = p.set.shapes[k];
        CHECK(relative_distance(p.set, p.average(corner, (k + 1) % 3), pose) < same);
        CHECK(relative_distance(p.set, family.at(corner, 0, nullptr).average.y, pose) < same);
        CHECK(relative_distance(p.set, p.reduced_average(subspace, corner, (k + 1) % 3), pose) < same);
        // A hundredth of the weight elsewhere is seen.
        const Weights beside = 0.99 * corner + 0.01 * corner_weights(3, (k + 1) % 3);
        CHECK(relative_distance(p.set, p.average(beside, k), pose) > different);
        CHECK(relative_distance(p.set, p.reduced_average(subspace, beside, k), pose) > different);
    }
}

TEST_CASE("homogeneity: only ratios of weights matter, unreduced and reduced")
{
    Problem p(tube_poses(3));
    const Subspace subspace = build_krylov_subspace(p.solver, { 1, 0, 256 }, nullptr);
    const Weights w = weights3(0.2, 0.5, 0.3);
    const Shape full = p.average(w), reduced = p.reduced_average(subspace, w);
    for (double factor : { 1e-3, 7.0, 1e4 }) {
        CHECK(relative_distance(p.set, p.average(factor * w), full) < same);
        CHECK(relative_distance(p.set, p.reduced_average(subspace, factor * w), reduced) < same);
    }
    const Weights other = weights3(0.2, 0.5, 0.301); // not a multiple
    CHECK(relative_distance(p.set, p.average(other), full) > different);
    CHECK(relative_distance(p.set, p.reduced_average(subspace, other), reduced) > different);
}

TEST_CASE("rigid invariance: poses moved rigidly, each in its own way, have the same average up to a rigid motion")
{
    // Without alignment this is a property of the energy alone ...
    Problem together(tube_poses(3)), scattered(scattered_tubes(0.4), true); // so little that they stay
    const Weights w = weights3(0.3, 0.3, 0.4);
    const Shape expected = together.average(w);
    REQUIRE(scattered.set.frame.size() > 0);
    CHECK(relative_distance(together.set, scattered.average(w), expected) < same);
    CHECK(relative_distance(together.set, scattered.average(weights3(0.3, 0.301, 0.4)), expected) > different);

    // ... and a reduced space, which no rotation of a pose leaves as it is, has it by alignment.
    Problem aligned(scattered_tubes());
    const KrylovOptions options { 1, 0, 256 };
    const Shape reduced = together.reduced_average(build_krylov_subspace(together.solver, options, nullptr), w);
    CHECK(relative_distance(together.set,
                            aligned.reduced_average(build_krylov_subspace(aligned.solver, options, nullptr), w), reduced)
          < same);
    const Subspace unaligned = build_krylov_subspace(scattered.solver, options, nullptr);
    CHECK(relative_distance(together.set, scattered.reduced_average(unaligned, w), reduced) > different);
}

TEST_CASE("the order of the poses does not matter, up to a rigid motion")
{
    Problem p(tube_poses(3));
    const Weights w = weights3(0.5, 0.2, 0.3);
    PoseSet turned = tube_poses(3);
    const std::size_t order[] = { 2, 0, 1 };
    // The aligned shapes, so that the reduced spaces can be compared too: which pose comes first decides where all others
    // go.
    for (std::size_t k = 0; k < 3; ++k) turned.positions[k] = to_input_units(p.set, p.set.shapes[order[k]]);
    Problem other(turned, true);
    const Weights permuted = weights3(w[2], w[0], w[1]);
    const Shape full = p.average(w);
    CHECK(relative_distance(p.set, other.average(permuted), full) < same);
    CHECK(relative_distance(p.set, other.average(w), full) > different); // the weights must follow

    const KrylovOptions options { 1, 0, 256 };
    const Subspace a = build_krylov_subspace(p.solver, options, nullptr),
                   b = build_krylov_subspace(other.solver, options, nullptr);
    CHECK(relative_distance(p.set, other.reduced_average(b, permuted), p.reduced_average(a, w)) < same);
}

TEST_CASE("tangent at a corner (equation 6) against finite differences of averages")
{
    Problem p(tube_poses(3));
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t j = 0; j < 3; ++j) {
            if (j == k) continue;
            const Weights corner = corner_weights(3, k), direction = corner_weights(3, j) - corner;
            const Shape& pose = p.set.shapes[k];
            const auto displacement = [&](double step) {
                Shape y = p.average(corner + step * direction, k);
                apply(best_rigid_motion(y, pose, p.set.masses), y); // the gauge of the tangent
                return Shape(y - pose);
            };
            // One-sided, since weights are not negative; second order: halving the step quarters the error.
            const auto difference = [&](double h) { return Shape((4 * displacement(h) - displacement(2 * h)) / (2 * h)); };
            const Shape tangent = p.solver.weight_derivatives(corner, pose, direction, false);
            const double coarse = (difference(1e-3) - tangent).norm() / tangent.norm(),
                         fine = (difference(5e-4) - tangent).norm() / tangent.norm();
            CHECK(fine < 1e-6);
            CHECK(fine < coarse / 3);
        }
}

TEST_CASE("with tangents in the space the reduced curve leaves a pose in the right direction: quadratic error, not linear")
{
    Problem p(tube_poses(2));
    const Subspace differences = build_krylov_subspace(p.solver, { 0, 1, 256 }, nullptr),
                   tangents = build_krylov_subspace(p.solver, { 0, 0, 256 }, nullptr);
    CHECK(differences.dimension() == 1);
    CHECK(tangents.dimension() == 3);
    const auto error = [&](const Subspace& subspace, double t) {
        const Weights w = (1 - t) * corner_weights(2, 0) + t * corner_weights(2, 1);
        return relative_distance(p.set, p.reduced_average(subspace, w), p.average(w));
    };
    const double t = 4e-3;
    const double linear = error(differences, t) / error(differences, t / 2),
                 quadratic = error(tangents, t) / error(tangents, t / 2);
    CHECK(linear > 1.8);
    CHECK(linear < 2.2);
    CHECK(quadratic > 3.5);
}
