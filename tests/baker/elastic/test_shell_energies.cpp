// Discrete Shells and ARAP against independent numbers, finite differences and their own symmetries.
#include "elastic/average/newton.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/energy/arap.h"
#include "elastic/energy/discrete_shells.h"
#include "golden_shells.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <doctest/doctest.h>
#include <memory>
#include <string>

using namespace pliant;

namespace {

// The set as the golden numbers mean it: no alignment, no normalization.
NormalizedPoses raw_set(const golden::Case& c)
{
    NormalizedPoses set;
    for (std::size_t i = 0; i < c.faces.size(); i += 3)
        set.triangles.push_back({ c.faces[i], c.faces[i + 1], c.faces[i + 2] });
    for (const auto& pose : c.poses) set.shapes.push_back(Eigen::Map<const Shape>(pose.data(), Eigen::Index(pose.size())));
    set.masses = Eigen::VectorXd::Zero(set.dof_count() / 3);
    for (const Shape& shape : set.shapes) set.masses += lumped_masses(shape, set.triangles) / double(set.pose_count());
    return set;
}

std::unique_ptr<Energy> make(const std::string& name, const NormalizedPoses& set)
{
    if (name == "arap") return std::make_unique<Arap>(set);
    ShellOptions options;
    options.thickness = 0.1;
    options.foldover_damping = 1;
    options.membrane = name == "edge" ? Membrane::edge : name == "stvk" ? Membrane::stvk : Membrane::neo_hookean;
    return std::make_unique<DiscreteShells>(set, options);
}

Eigen::VectorXd vector(const std::vector<double>& v)
{
    return Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size()));
}

double relative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).norm() / b.norm(); }

template <class Test> void for_all_models(Test test)
{
    for (const golden::Case& c : golden::cases()) {
        const NormalizedPoses set = raw_set(c);
        for (const golden::Model& model : c.models) {
            CAPTURE(c.name);
            CAPTURE(model.name);
            test(c, model, set, *make(model.name, set));
        }
    }
}

} // namespace

TEST_CASE("energies equal the independent numbers to 1e-12")
{
    for_all_models([](const golden::Case& c, const golden::Model& model, const NormalizedPoses& set, const Energy& energy) {
        for (std::size_t k = 0; k < set.pose_count(); ++k) {
            const double value = energy_value(energy, corner_weights(set.pose_count(), k), vector(c.config));
            CHECK(std::abs(value - model.energies[k]) <= 1e-12 * std::abs(model.energies[k]));
            for (std::size_t j = 0; j < set.pose_count(); ++j) {
                const double cross = energy_value(energy, corner_weights(set.pose_count(), k), set.shapes[j]);
                CHECK(std::abs(cross - model.pose_to_pose[k][j]) <= 1e-12 * std::abs(model.pose_to_pose[k][j]) + 1e-14);
            }
        }
    });
}

TEST_CASE("gradients equal the independent numbers to 1e-10, Hessian products to 1e-9")
{
    for_all_models([](const golden::Case& c, const golden::Model& model, const NormalizedPoses&, const Energy& energy) {
        Shape gradient = Shape::Zero(energy.dof_count());
        add_gradient(energy, vector(c.weights), vector(c.config), gradient);
        CHECK(relative(gradient, vector(model.gradient)) < 1e-10);
        HessianAssembler assembler(energy);
        assembler.assemble(vector(c.weights), vector(c.config), HessianKind::exact);
        const Shape product = assembler.matrix().selfadjointView<Eigen::Lower>() * vector(c.direction);
        CHECK(relative(product, vector(model.hessian_product)) < 1e-9);
    });
}

TEST_CASE("averages equal the independent ones to 1e-8 after rigid alignment")
{
    for_all_models([](const golden::Case& c, const golden::Model& model, const NormalizedPoses& set, const Energy& energy) {
        if (model.average.empty()) return;
        for (SolverKind kind : { SolverKind::cholmod, SolverKind::eigen }) {
            NewtonSolver solver(energy, set, kind);
            NewtonOptions options;
            options.decrement = 1e-14;
            const NewtonResult result = solver.minimize(vector(c.weights), set.shapes[0], options);
            CHECK(result.has_converged);
            Shape aligned = result.y;
            const Shape reference = vector(model.average);
            apply(best_rigid_motion(aligned, reference, set.masses), aligned);
            CHECK(relative(aligned, reference) < 1e-8);
            CHECK(std::abs(result.energy - model.average_energy) <= 1e-10 * std::abs(model.average_energy));
        }
    });
}

// How far the vectors of a face lean: the derivative of the sum of squares that its shear minimizes.
double leaning(const RuntimeElement& face, const NormalizedPoses& set)
{
    double sum = 0;
    for (const Shape& shape : set.shapes) {
        Eigen::Matrix<double, 3, 2> edges;
        for (std::size_t i = 0; i < 2; ++i)
            edges.col(Eigen::Index(i)) = point(shape, face.differences[i][1]) - point(shape, face.differences[i][0]);
        const Eigen::Matrix2d g = (edges * face.combination).transpose() * (edges * face.combination);
        sum += g(0, 0) * g(0, 1) / g.determinant();
    }
    return sum;
}

// The corner that a file begins a face with changes nothing. From the tip of a needle the noise of single precision was 1e-3
// of the energy, and jumps went to the wrong minimum.
TEST_CASE("the runtime sees a face along its longest edge and its height, whichever corner the file begins with")
{
    for (const golden::Case& c : golden::cases())
        for (const std::string membrane : { "neo-hookean", "stvk", "edge" }) {
            NormalizedPoses set = raw_set(c);
            const std::unique_ptr<Energy> energy = make(membrane, set);
            for (Triangle& t : set.triangles) t = { t[1], t[2], t[0] };
            const std::unique_ptr<Energy> turned = make(membrane, set);
            for (std::size_t e = energy->element_count() - set.triangles.size(); e < energy->element_count(); ++e) {
                const RuntimeElement a = energy->runtime_element(e, set.shapes[0]);
                const RuntimeElement b = turned->runtime_element(e, set.shapes[0]);
                CHECK(a.differences == b.differences);
                CHECK(a.combination == b.combination);
                CHECK(a.fixed == b.fixed);
                CHECK(a.pose_numbers == b.pose_numbers);
                if (membrane != "edge") CHECK(std::abs(leaning(a, set)) < 1e-9);
                const auto length = [&](std::uint32_t i, std::uint32_t j) {
                    return (point(set.shapes[0], i) - point(set.shapes[0], j)).norm();
                };
                const std::uint32_t x0 = a.differences[0][0], x1 = a.differences[0][1], x2 = a.differences[1][1];
                const double longest = membrane == "edge" ? length(x1, x2) : length(x0, x1);
                CHECK(longest >= std::max({ length(x0, x1), length(x1, x2), length(x2, x0) }));
            }
        }
}

// Rounding made it indefinite in slivers 0.003 times as high as long: blends grew to 1e6 diagonals.
TEST_CASE("the energy of a St. Venant-Kirchhoff sliver stays convex in single precision")
{
    PoseSet poses;
    for (const double lean : { 0.5, 0.3 }) {
        Positions sliver(4, 3);
        sliver << 0, 0, 0, 1, 0, 0, lean, 1e-3, 0, 0.5, 1, 0;
        poses.positions.push_back(sliver);
    }
    poses.triangles = { { 2, 0, 1 }, { 2, 1, 3 }, { 0, 2, 3 } };
    const NormalizedPoses set = normalize(poses);
    const std::unique_ptr<Energy> energy = make("stvk", set);
    for (std::size_t e = energy->element_count() - 3; e < energy->element_count(); ++e) {
        const RuntimeElement element = energy->runtime_element(e, set.shapes[0]);
        for (Eigen::Index k = 0; k < 2; ++k) {
            const Eigen::MatrixXd q = element.pose_numbers.row(k).tail(6).cast<float>().cast<double>();
            Eigen::Matrix3d quadratic;
            quadratic << q(0), q(1), q(2), q(1), q(3), q(4), q(2), q(4), q(5);
            const Eigen::Vector3d scale = quadratic.diagonal().cwiseSqrt().cwiseInverse();
            const Eigen::Matrix3d scaled = scale.asDiagonal() * quadratic * scale.asDiagonal();
            CAPTURE(e);
            CAPTURE(k);
            CHECK(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scaled).eigenvalues()[0] > 5e-7);
        }
    }
}

TEST_CASE("ARAP cells are never negative, however obtuse the triangles")
{
    // A hexagon with a flat triangle on each side.
    PoseSet poses;
    Positions flat(13, 3);
    flat.row(0).setZero();
    for (std::uint32_t i = 0; i < 6; ++i) {
        const double angle = 1.0471975511965976 * i;
        flat.row(1 + i) << std::cos(angle), std::sin(angle), 0;
        flat.row(7 + i) << 0.9 * std::cos(angle + 0.52), 0.9 * std::sin(angle + 0.52), 0;
        poses.triangles.push_back({ 0, 1 + i, 1 + (i + 1) % 6 });
        poses.triangles.push_back({ 1 + i, 7 + i, 1 + (i + 1) % 6 });
    }
    poses.positions = { flat };
    const NormalizedPoses set = normalize(poses);
    const Arap energy(set);
    ElementResult result;
    for (std::size_t e = 0; e < energy.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy.element_vertices(e, count);
        for (Eigen::Index moved = 0; moved < Eigen::Index(count); ++moved) {
            Eigen::Matrix3Xd x(3, Eigen::Index(count));
            for (std::size_t i = 0; i < count; ++i) x.col(Eigen::Index(i)) = point(set.shapes[0], vertices[i]);
            x.col(moved) += Eigen::Vector3d(0.1, -0.2, 0.3);
            energy.evaluate(e, corner_weights(1, 0).data(), x.data(), Order::value, HessianKind::exact, result);
            CAPTURE(e);
            CHECK(result.value > 0); // with the cotangents of both faces at the rims some are -24
        }
    }
}

TEST_CASE("rigid motions do no work at a pose: the Hessian has exactly six null modes and is positive semidefinite")
{
    for_all_models([](const golden::Case& c, const golden::Model& model, const NormalizedPoses& set, const Energy& energy) {
        if (set.dof_count() < 18 && std::string(model.name) == "arap") return; // too few edges for a stiff ARAP
        HessianAssembler assembler(energy);
        const Weights w = corner_weights(c.poses.size(), 0);
        assembler.assemble(w, set.shapes[0], HessianKind::exact);
        const Eigen::MatrixXd dense = Eigen::MatrixXd(assembler.matrix()).selfadjointView<Eigen::Lower>();
        const Eigen::MatrixXd modes = rigid_modes(set.shapes[0], set.masses);
        CHECK((dense * modes).norm() < 1e-9 * dense.norm() * modes.norm());
        const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
        CHECK(eigenvalues[0] > -1e-10 * eigenvalues[eigenvalues.size() - 1]);
        CHECK(eigenvalues[5] < 1e-10 * eigenvalues[eigenvalues.size() - 1]);
        CHECK(eigenvalues[6] > 1e-8 * eigenvalues[eigenvalues.size() - 1]);
    });
}

TEST_CASE("projected Hessians are positive semidefinite everywhere")
{
    for_all_models([](const golden::Case& c, const golden::Model&, const NormalizedPoses&, const Energy& energy) {
        HessianAssembler assembler(energy);
        const Shape far = vector(c.config) + 0.2 * vector(c.direction);
        assembler.assemble(vector(c.weights), far, HessianKind::projected);
        const Eigen::MatrixXd dense = Eigen::MatrixXd(assembler.matrix()).selfadjointView<Eigen::Lower>();
        const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
        CHECK(eigenvalues[0] > -1e-12 * eigenvalues[eigenvalues.size() - 1]);
    });
}

TEST_CASE("exact Hessians are the finite differences of gradients")
{
    for_all_models([](const golden::Case& c, const golden::Model&, const NormalizedPoses&, const Energy& energy) {
        const Shape x = vector(c.config), direction = vector(c.direction);
        const double step = 1e-6;
        Shape plus = Shape::Zero(x.size()), minus = plus;
        add_gradient(energy, vector(c.weights), x + step * direction, plus);
        add_gradient(energy, vector(c.weights), x - step * direction, minus);
        HessianAssembler assembler(energy);
        assembler.assemble(vector(c.weights), x, HessianKind::exact);
        const Shape product = assembler.matrix().selfadjointView<Eigen::Lower>() * direction;
        CHECK(relative(product, (plus - minus) / (2 * step)) < 1e-6);
    });
}

TEST_CASE("fold-over hinges are found and damped")
{
    const golden::Case c = golden::cases()[1]; // a single hinge
    NormalizedPoses set = raw_set(c);
    ShellOptions options;
    options.thickness = 0.1;
    CHECK(DiscreteShells(set, options).foldover_hinges().empty());
    // Fold the free vertex over by 2.5 radians in pose 0.
    const double angle = 2.5;
    set.shapes[0].segment<3>(9) = point(set.shapes[0], 1) + point(set.shapes[0], 2);
    const Eigen::Vector3d origin = point(set.shapes[0], 1), axis = (point(set.shapes[0], 2) - origin).normalized();
    set.shapes[0].segment<3>(9) = origin + Eigen::AngleAxisd(angle, axis) * (point(set.shapes[0], 3) - origin);
    const DiscreteShells damped(set, options);
    CHECK(damped.foldover_hinges().size() == 1);
    options.foldover_damping = 1;
    const DiscreteShells undamped(set, options);
    ElementResult a, b;
    double x[12];
    std::size_t count = 0;
    gather(damped.element_vertices(0, count), 4, set.shapes[1], x);
    const Weights w = corner_weights(2, 0);
    damped.evaluate(0, w.data(), x, Order::value, HessianKind::exact, a);
    undamped.evaluate(0, w.data(), x, Order::value, HessianKind::exact, b);
    CHECK(a.value == doctest::Approx(1e-3 * b.value));
}
