// Discrete shells with ARAP cells at rough vertices: which vertices these are, and that the energy is what its parts are.
#include "base/mesh/align.h"
#include "elastic/average/hessian.h"
#include "elastic/energy/reinforced_shells.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

constexpr std::uint32_t side = 9; // vertices

// A square sheet of side 1, folded by this angle about its middle line.
Positions folded(double angle)
{
    Positions points(side * side, 3);
    for (std::uint32_t i = 0; i < side; ++i)
        for (std::uint32_t j = 0; j < side; ++j) {
            const double x = double(i) / (side - 1) - 0.5, y = double(j) / (side - 1);
            const double turn = x > 0 ? angle : 0;
            points.row(i * side + j) << x * std::cos(turn), y, x * std::sin(turn);
        }
    return points;
}

NormalizedPoses sheet(const std::vector<double>& angles)
{
    PoseSet poses;
    for (const double angle : angles) poses.positions.push_back(folded(angle));
    for (std::uint32_t i = 0; i + 1 < side; ++i)
        for (std::uint32_t j = 0; j + 1 < side; ++j) {
            const std::uint32_t a = i * side + j, b = a + side;
            poses.triangles.push_back({ a, b, a + 1 });
            poses.triangles.push_back({ b, b + 1, a + 1 });
        }
    return normalize(poses);
}

Shape disturbed(const NormalizedPoses& set, double size)
{
    Shape shape = set.shapes[0];
    for (Eigen::Index i = 0; i < shape.size(); ++i) shape[i] += size * std::sin(1.7 * double(i * i % 97));
    return shape;
}

std::uint32_t first_vertex(const Energy& energy, std::size_t element)
{
    std::size_t count = 0;
    return energy.element_vertices(element, count)[0];
}

} // namespace

TEST_CASE("a smooth surface is a plain shell, to the last bit")
{
    const NormalizedPoses set = sheet({ 0, 0.3 });
    const ReinforcedShells energy(set, ShellOptions());
    const DiscreteShells plain(set, ShellOptions());
    CHECK(energy.rough_count() == 0);
    REQUIRE(energy.element_count() == plain.element_count());
    const Shape y = disturbed(set, 0.01);
    CHECK(energy_value(energy, equal_weights(2), y) == energy_value(plain, equal_weights(2), y));
}

TEST_CASE("vertices of a crease are rough, in whichever pose it is one")
{
    for (const std::vector<double>& angles : { std::vector<double> { 0, 1.8 }, { 1.8, 0 }, { 1.8, 1.8 } }) {
        const ReinforcedShells energy(sheet(angles), ShellOptions());
        CHECK(energy.rough_count() == side);
        CHECK(energy.roughest_vertex() / side == side / 2);
        for (std::size_t e = energy.element_count() - side; e < energy.element_count(); ++e)
            CHECK(first_vertex(energy, e) / side == side / 2);
    }
}

TEST_CASE("no fold-over hinge is left")
{
    const NormalizedPoses set = sheet({ 0, 2.6 });
    const DiscreteShells plain(set, ShellOptions());
    const ReinforcedShells energy(set, ShellOptions());
    CHECK(plain.foldover_hinges().size() == side - 1);
    CHECK(energy.element_count() == plain.element_count() - (side - 1) + side);
}

TEST_CASE("poses have no energy, other shapes have; derivatives are those of the values")
{
    const NormalizedPoses set = sheet({ 0, 1.8 });
    const ReinforcedShells energy(set, ShellOptions());
    for (std::size_t k = 0; k < 2; ++k) CHECK(energy_value(energy, corner_weights(2, k), set.shapes[k]) < 1e-25);
    const Weights w = equal_weights(2);
    const Shape y = disturbed(set, 0.01), direction = disturbed(set, 0.3) - set.shapes[0];
    CHECK(energy_value(energy, w, y) > 1e-4);

    const double step = 1e-6;
    Shape gradient = Shape::Zero(y.size()), plus = gradient, minus = gradient;
    add_gradient(energy, w, y, gradient);
    const double up = add_gradient(energy, w, y + step * direction, plus);
    const double down = add_gradient(energy, w, y - step * direction, minus);
    CHECK(gradient.dot(direction) == doctest::Approx((up - down) / (2 * step)).epsilon(1e-6));
    HessianAssembler assembler(energy);
    assembler.assemble(w, y, HessianKind::exact);
    const Shape product = assembler.matrix().selfadjointView<Eigen::Lower>() * direction;
    CHECK((product - (plus - minus) / (2 * step)).norm() < 1e-5 * product.norm());
}

TEST_CASE("triangles count by their share of smooth vertices, also at run time")
{
    const NormalizedPoses set = sheet({ 0, 1.8 });
    const ReinforcedShells energy(set, ShellOptions());
    const DiscreteShells plain(set, ShellOptions());
    const auto stretch = [&](const Energy& of, std::size_t element) {
        return of.runtime_element(element, set.shapes[0]).pose_numbers.row(0).cwiseAbs().sum();
    };
    // Beside the crease. Of two triangles it is the first vertex: one lies on its side, one has a vertex on the crease.
    const std::uint32_t corner = (side / 2 - 1) * side;
    double sum = 0, expected = 0;
    for (std::size_t e = 0; e < energy.element_count() - side; ++e) {
        std::size_t count = 0;
        if (energy.element_vertices(e, count)[0] == corner && count == 3) sum += stretch(energy, e);
    }
    for (std::size_t e = plain.hinge_count(); e < plain.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* v = plain.element_vertices(e, count);
        const bool is_at_crease = v[1] / side == side / 2;
        if (v[0] == corner) expected += (is_at_crease ? 2.0 / 3 : 1) * stretch(plain, e);
    }
    CHECK(sum == doctest::Approx(expected).epsilon(1e-12));
}
