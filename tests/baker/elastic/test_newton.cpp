// Newton's method: steps that turn without stretching, steps that reuse a factor, steps that slivers do not shorten, and
// how few factorisations that takes.
#include "../tube.h"
#include "../twisted_bar.h"
#include "base/mesh/align.h"
#include "elastic/average/lbfgs.h"
#include "elastic/average/newton.h"
#include "elastic/average/restraint.h"
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

TEST_CASE("slivers that open and close do not hold back the whole body")
{
    const NormalizedPoses set = tube_with_slivers();
    const ReinforcedShells shells(set, ShellOptions());
    NewtonSolver solver(shells, set, default_solver());
    const NewtonResult result = solver.minimize(equal_weights(2), set.shapes[0], NewtonOptions());
    CHECK(result.has_converged);
    CHECK(result.residual < 1e-3);
    CHECK(solver.factorization_count() <= 16); // 33 if the whole step is shortened
}

TEST_CASE("a stiffened cell keeps its size, and the step stays one of descent")
{
    const NormalizedPoses set = bent_tube(1);
    const ReinforcedShells shells(set, ShellOptions());
    const Shape& y = set.shapes[0];
    HessianAssembler assembler(shells);
    assembler.assemble(equal_weights(2), y, HessianKind::projected);
    SparseLower hessian = assembler.matrix();
    for (Eigen::Index i = 0; i < hessian.cols(); ++i) hessian.coeffRef(i, i) += 1; // definite
    SparseCholesky cholesky(default_solver());
    REQUIRE(cholesky.factorize(hessian));
    const auto solve = [&](const Eigen::MatrixXd& loads) { return cholesky.solve(loads); };

    // A load that pulls one corner towards the other two, until the cell collapses.
    const Triangle cell = set.triangles[40];
    Shape load = Shape::Zero(y.size()), step = load;
    load.segment<3>(3 * Eigen::Index(cell[0])) = (point(y, cell[1]) + point(y, cell[2])) / 2 - point(y, cell[0]);
    std::vector<std::uint32_t> cells;
    for (int i = 0; i < 20 && cells.empty(); ++i) {
        load *= 2;
        step = solve(load);
        cells = collapsing_cells(set, y, y + step);
    }
    REQUIRE(!cells.empty());
    Shape restrained = step;
    const std::vector<Eigen::Index> pins = { 0, 1, 2 };
    for (double share = 0.1; share < 1000 && !cells.empty(); share *= 3) {
        restrain(hessian, set, cells, share, pins, restrained);
        cells = collapsing_cells(set, y, y + restrained);
    }
    CHECK(cells.empty());
    CHECK(load.dot(restrained) > 0.01 * load.dot(step));
    CHECK(restrained.head<3>() == step.head<3>());
    // Next to the step of the whole stiffened model.
    const Shape left = load - hessian.selfadjointView<Eigen::Lower>() * restrained;
    CHECK(left.dot(Shape(solve(left))) < 0.01 * load.dot(step));
}
