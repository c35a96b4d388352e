// Newton's method: steps that turn without stretching, steps that reuse a factor, steps that slivers do not shorten, and
// how few factorisations that takes.
#include "../tube.h"
#include "../twisted_bar.h"
#include "base/mesh/align.h"
#include "elastic/average/lbfgs.h"
#include "elastic/average/newton.h"
#include "elastic/average/relaxation.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/average/warp.h"
#include "elastic/energy/reinforced_shells.h"
#include "elastic/energy/solid.h"

#include <Eigen/Dense>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

// Straight, and bent by this angle.
NormalizedPoses bent_tube(double bend)
{
    PoseSet poses = tube_poses(2);
    poses.positions[1] = Tube().pose(bend, 0);
    return normalize(poses);
}

// Bent, and vertices here and there slide almost onto their neighbours to the one side or the other: triangles open and
// close by a factor of two hundred.
NormalizedPoses tube_with_slivers()
{
    const Tube tube;
    PoseSet poses = tube_poses(2);
    const auto slide = [&](Positions& positions, std::uint32_t ring, std::uint32_t side, std::uint32_t towards) {
        const std::uint32_t v = ring * tube.side_count + side, to = ring * tube.side_count + towards % tube.side_count;
        positions.row(v) += 0.995 * (positions.row(to) - positions.row(v));
    };
    poses.positions[1] = tube.pose(1, 0);
    for (std::uint32_t ring = 2; ring < 22; ring += 4) {
        slide(poses.positions[0], ring, 5, 6);
        slide(poses.positions[1], ring, 5, 4);
    }
    return normalize(poses);
}

// The displacement that turns the shape by an angle to first order, and the turned shape.
struct Turn {
    Shape step, shape;
};
Turn turn(const Shape& y, const Eigen::Vector3d& axis, double angle)
{
    Turn out { Shape(y.size()), Shape(y.size()) };
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    for (Eigen::Index i = 0; i < y.size(); i += 3) {
        out.step.segment<3>(i) = angle * axis.cross(Eigen::Vector3d(y.segment<3>(i)));
        out.shape.segment<3>(i) = rotation * y.segment<3>(i);
    }
    return out;
}

// Relative to the step, after rigid alignment.
double distance(const NormalizedPoses& set, const Shape& a, Shape b, const Shape& step)
{
    apply(best_rigid_motion(b, a, set.masses), b);
    return (a - b).norm() / step.norm();
}

} // namespace

TEST_CASE("a warped displacement turns what it would stretch")
{
    const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 3).normalized();
    for (const NormalizedPoses& set : { bent_tube(1), normalize(twisted_bar(2, 6, 1)) }) {
        CAPTURE(set.is_solid());
        const Warp warp(set, default_solver());
        const Shape& y = set.shapes[1];
        const Turn turned = turn(y, axis, 1.2);
        CHECK(distance(set, turned.shape, y + turned.step, turned.step) > 0.2);
        CHECK(distance(set, turned.shape, warp(y, turned.step), turned.step) < 1e-4);
    }
}

TEST_CASE("a warped displacement is the displacement to first order, and exactly that at fixed vertices")
{
    for (NormalizedPoses set : { bent_tube(1), normalize(twisted_bar(2, 6, 1)) }) {
        CAPTURE(set.is_solid());
        set.fixed_vertices = { 3, 7 };
        const Warp warp(set, default_solver());
        const Shape& y = set.shapes[0];
        const Shape step = set.shapes[1] - y;
        const auto off = [&](double share) { return (warp(y, share * step) - y - share * step).norm(); };
        CHECK(off(0.01) < 0.3 * off(0.02)); // second order
        CHECK(off(0.02) < 0.02 * step.norm());
        const Shape moved = warp(y, step);
        for (const std::uint32_t v : set.fixed_vertices)
            CHECK((point(moved, v) - point(y, v) - point(step, v)).norm() < 1e-12);
    }
}

TEST_CASE("steps of limited-memory BFGS end at the minimum of a quadratic function")
{
    const Eigen::Index n = 12;
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) hessian(i, i) = 1 + double(i % 4); // of four values
    const Shape minimum = Shape::LinSpaced(n, -1, 2);
    Shape y = Shape::Zero(n), gradient = hessian * (y - minimum);
    LimitedMemoryBfgs memory;
    for (int i = 0; i < 4; ++i) { // one for each value, with exact line searches
        const Shape step = memory.direction(gradient, [](const Shape& load) -> Shape { return load; });
        REQUIRE(gradient.dot(step) < 0);
        const Shape change = hessian * step;
        const Shape taken = step * (-gradient.dot(step) / step.dot(change));
        y += taken;
        const Shape next = hessian * (y - minimum);
        memory.add(taken, next - gradient);
        gradient = next;
    }
    CHECK((y - minimum).norm() < 1e-8);
}

TEST_CASE("limited-memory BFGS learns nothing where the function is not convex")
{
    const Shape ones = Shape::Ones(5);
    LimitedMemoryBfgs memory;
    memory.add(ones, -ones);
    CHECK(memory.direction(ones, [](const Shape& load) -> Shape { return load; }) == -ones);
}

TEST_CASE("an average of poses far apart takes few factorisations")
{
    const NormalizedPoses tube = bent_tube(2.5), bar = normalize(twisted_bar(3, 18, 2.5));
    const ReinforcedShells shells(tube, ShellOptions());
    const Solid solid(bar, SolidOptions());
    const auto count = [](const Energy& energy, const NormalizedPoses& set) {
        NewtonSolver solver(energy, set, default_solver());
        const NewtonResult result = solver.minimize(equal_weights(2), set.shapes[0], NewtonOptions());
        CHECK(result.has_converged);
        CHECK(result.residual < 1e-4);
        return solver.factorization_count();
    };
    CHECK(count(shells, tube) <= 5); // 7 without steps that reuse a factor
    CHECK(count(solid, bar) <= 6);   // 8 without warped steps
}

TEST_CASE("an average next to the last one needs no factorisation")
{
    const NormalizedPoses set = bent_tube(0.5);
    const ReinforcedShells shells(set, ShellOptions());
    NewtonOptions options;
    options.step_floor = 1e-5 * mass_norm(set.shapes[0], set.masses);
    NewtonSolver solver(shells, set, default_solver());
    const Shape mean = solver.minimize(equal_weights(2), set.shapes[0], NewtonOptions()).y;
    const Weights w = equal_weights(2) + 0.1 * (corner_weights(2, 1) - corner_weights(2, 0));
    solver.factorize_equilibrium(equal_weights(2), mean);
    const int count = solver.factorization_count();
    options.has_near_factor = true;
    const NewtonResult near = solver.minimize(w, mean, options);
    CHECK(near.has_converged);
    CHECK(solver.factorization_count() == count);
    const Shape exact = solver.minimize(w, mean, NewtonOptions()).y;
    CHECK(mass_norm(near.y - exact, set.masses) < 2 * options.step_floor);
    CHECK(mass_norm(mean - exact, set.masses) > 20 * options.step_floor);
}

TEST_CASE("slivers that open and close do not hold back the whole body")
{
    const NormalizedPoses set = tube_with_slivers();
    const ReinforcedShells shells(set, ShellOptions());
    NewtonSolver solver(shells, set, default_solver());
    const NewtonResult result = solver.minimize(equal_weights(2), set.shapes[0], NewtonOptions());
    CHECK(result.has_converged);
    CHECK(result.residual < 1e-3);
    CHECK(solver.factorization_count() <= 8); // 7; 33 if the whole step is shortened
}

namespace {

// Pushes one corner of a triangle onto the opposite edge, so that the triangle collapses.
Shape with_collapsed_triangle(const NormalizedPoses& set, const Shape& y, std::size_t triangle)
{
    const Triangle& t = set.triangles[triangle];
    Shape moved = y;
    moved.segment<3>(3 * Eigen::Index(t[0])) = (point(y, t[1]) + point(y, t[2])) / 2;
    return moved;
}

std::size_t moved_count(const Shape& a, const Shape& b)
{
    std::size_t count = 0;
    for (Eigen::Index v = 0; v < a.size(); v += 3) count += a.segment<3>(v) != b.segment<3>(v);
    return count;
}

} // namespace

TEST_CASE("a collapsed cell is mended near itself, and the energy there is the lowest")
{
    const NormalizedPoses set = bent_tube(1);
    const ReinforcedShells shells(set, ShellOptions());
    const Weights w = corner_weights(2, 0);
    const Shape y = set.shapes[0]; // the minimum
    Shape moved = with_collapsed_triangle(set, y, 40);
    const std::vector<std::uint32_t> cells = collapsing_cells(set, y, moved);
    REQUIRE(!cells.empty());
    const Relaxation relaxation(shells, set);
    CHECK(relaxation.mend(w, y, cells, moved));
    CHECK(collapsing_cells(set, y, moved).empty());
    CHECK((moved - y).norm() < 1e-6 * y.norm());
}

TEST_CASE("patches move where the energy of elements rises, and nothing else does")
{
    const NormalizedPoses set = bent_tube(1);
    const ReinforcedShells shells(set, ShellOptions());
    const Weights w = corner_weights(2, 0);
    const Shape y = set.shapes[0];
    const Triangle& t = set.triangles[40];
    Shape pushed = y;
    pushed.segment<3>(3 * Eigen::Index(t[0])) += 0.3 * (point(y, t[1]) - point(y, t[0]));
    const double before = energy_value(shells, w, pushed);
    const Relaxation relaxation(shells, set);
    Shape relaxed = pushed;
    CHECK(relaxation.lower(w, y, before / 100, relaxed));
    CHECK(energy_value(shells, w, relaxed) < 1e-3 * before);
    CHECK(moved_count(pushed, relaxed) > 0);
    CHECK(moved_count(pushed, relaxed) < std::size_t(set.dof_count()) / 6); // half of the vertices
    Shape still = pushed;
    CHECK(!relaxation.lower(w, y, 2 * before, still)); // no element rises that far
    CHECK(still == pushed);
}

TEST_CASE("vertices settle that are far from balance, and nothing else moves")
{
    const NormalizedPoses set = bent_tube(1);
    const ReinforcedShells shells(set, ShellOptions());
    const Weights w = corner_weights(2, 0);
    const Shape y = set.shapes[0];
    const Triangle& t = set.triangles[40];
    Shape pushed = y;
    pushed.segment<3>(3 * Eigen::Index(t[0])) += 0.1 * (point(y, t[1]) - point(y, t[0]));
    const double before = energy_value(shells, w, pushed);
    const Relaxation relaxation(shells, set);
    Shape settled = pushed;
    relaxation.settle(w, before / 100, settled);
    CHECK(energy_value(shells, w, settled) < 1e-3 * before);
    CHECK(moved_count(pushed, settled) < std::size_t(set.dof_count()) / 6); // half of the vertices
    Shape still = pushed;
    relaxation.settle(w, 2 * before, still);
    CHECK(still == pushed);
}

TEST_CASE("fixed vertices are no part of a patch")
{
    NormalizedPoses set = bent_tube(1);
    const Triangle& t = set.triangles[40];
    set.fixed_vertices = { t[0] };
    const ReinforcedShells shells(set, ShellOptions());
    const Shape y = set.shapes[0];
    Shape pushed = y;
    pushed.segment<3>(3 * Eigen::Index(t[0])) += 0.3 * (point(y, t[1]) - point(y, t[0]));
    const Weights w = corner_weights(2, 0);
    Shape relaxed = pushed;
    CHECK(Relaxation(shells, set).lower(w, y, 1e-9, relaxed));
    CHECK(point(relaxed, t[0]) == point(pushed, t[0]));
}
