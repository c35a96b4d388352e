// Solids against independent numbers, finite differences, and their form for the runtime.
#include "../twisted_bar.h"
#include "base/mesh/tets.h"
#include "elastic/average/newton.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/energy/solid.h"
#include "golden_solids.h"
#include "pliant_format.h"
#include "reduced/surrogate/quartic.h"

#include <Eigen/Dense>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace pliant;

namespace {

Eigen::VectorXd vector(const std::vector<double>& v)
{
    return Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size()));
}

double relative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).norm() / b.norm(); }

// Poses X and Y as they are: no alignment, no normalization.
NormalizedPoses raw_set(const golden::SolidCase& c)
{
    NormalizedPoses set;
    for (std::size_t i = 0; i < c.tets.size(); i += 4)
        set.tets.push_back({ c.tets[i], c.tets[i + 1], c.tets[i + 2], c.tets[i + 3] });
    set.shapes = { vector(c.rest), vector(c.current) };
    set.masses = 0.5 * (lumped_tet_masses(set.shapes[0], set.tets) + lumped_tet_masses(set.shapes[1], set.tets));
    return set;
}

Solid make(const golden::SolidCase& c, const NormalizedPoses& set)
{
    SolidOptions options;
    options.law = c.is_mooney_rivlin ? SolidLaw::mooney_rivlin : SolidLaw::stvk;
    // The moduli of the numbers as a Young's modulus and Poisson's ratio: mu10 is 0.4 of the shear modulus.
    NormalizedPoses scaled = set;
    const double shear = c.is_mooney_rivlin ? c.a / 0.4 : c.b, bulk = c.is_mooney_rivlin ? 2 * c.c : c.a + 2 * c.b / 3;
    options.poisson = (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear));
    return Solid(scaled, options);
}

// Young's modulus is 1 in the class: energies scale with it.
double young(const golden::SolidCase& c)
{
    const double shear = c.is_mooney_rivlin ? c.a / 0.4 : c.b, bulk = c.is_mooney_rivlin ? 2 * c.c : c.a + 2 * c.b / 3;
    return 9 * bulk * shear / (3 * bulk + shear);
}

const Weights from_rest = corner_weights(2, 0);

template <class Test> void for_all_cases(Test test)
{
    for (const golden::SolidCase& c : golden::solid_cases()) {
        CAPTURE(c.name);
        CAPTURE(c.is_mooney_rivlin);
        const NormalizedPoses set = raw_set(c);
        test(c, set, make(c, set));
    }
}

} // namespace

TEST_CASE("energies, gradients and Hessian products of solids equal the independent numbers")
{
    for_all_cases([](const golden::SolidCase& c, const NormalizedPoses&, const Solid& solid) {
        const double scale = young(c);
        const Shape y = vector(c.current);
        CHECK(std::abs(scale * energy_value(solid, from_rest, y) - c.energy) <= 1e-12 * c.energy);
        Shape gradient = Shape::Zero(y.size());
        add_gradient(solid, from_rest, y, gradient);
        CHECK(relative(scale * gradient, vector(c.gradient)) < 1e-10);
        HessianAssembler assembler(solid);
        assembler.assemble(from_rest, y, HessianKind::exact);
        const Shape product = assembler.matrix().selfadjointView<Eigen::Lower>() * vector(c.direction);
        CHECK(relative(scale * product, vector(c.hessian_product)) < 1e-9);
        const double inverted = energy_value(solid, from_rest, vector(c.inverted));
        if (c.is_mooney_rivlin)
            CHECK(inverted == std::numeric_limits<double>::infinity());
        else
            CHECK(std::abs(scale * inverted - c.inverted_energy) <= 1e-12 * c.inverted_energy);
    });
}

TEST_CASE("averages of solids have the edge lengths and energies of the independent ones")
{
    for_all_cases([](const golden::SolidCase& c, const NormalizedPoses& set, const Solid& solid) {
        for (const golden::SolidAverage& average : c.averages) {
            NewtonSolver solver(solid, set, SolverKind::eigen);
            NewtonOptions options;
            options.decrement = 1e-14;
            const NewtonResult result = solver.minimize(vector(average.weights), set.shapes[0], options);
            CHECK(result.has_converged);
            CHECK(std::abs(young(c) * result.energy - average.energy) <= 1e-9 * average.energy);
            Eigen::VectorXd lengths(average.edge_lengths.size());
            for (std::size_t e = 0; e < c.edges.size(); e += 2)
                lengths[Eigen::Index(e / 2)] = (point(result.y, c.edges[e]) - point(result.y, c.edges[e + 1])).norm();
            CHECK(relative(lengths, vector(average.edge_lengths)) < 1e-8);
        }
    });
}

TEST_CASE("a solid at rest has exactly no energy, six null modes, and none of it depends on where it stands")
{
    for_all_cases([](const golden::SolidCase& c, const NormalizedPoses& set, const Solid& solid) {
        CHECK(energy_value(solid, from_rest, set.shapes[0]) == 0);
        HessianAssembler assembler(solid);
        assembler.assemble(from_rest, set.shapes[0], HessianKind::exact);
        const Eigen::MatrixXd dense = Eigen::MatrixXd(assembler.matrix()).selfadjointView<Eigen::Lower>();
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
        CHECK(std::abs(values[0]) < 1e-12 * values[values.size() - 1]);
        CHECK(values[5] < 1e-12 * values[values.size() - 1]);
        CHECK(values[6] > 1e-6 * values[values.size() - 1]);
        Shape moved = vector(c.current);
        apply({ Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix(), { 3, -2, 5 } }, moved);
        CHECK(energy_value(solid, from_rest, moved)
              == doctest::Approx(energy_value(solid, from_rest, vector(c.current))).epsilon(1e-12));
    });
}

namespace {

// The runtime's element as formats/SPEC.md states it for kinds 6 and 7, in plain double precision: f for columns of F = I +
// D.
double runtime_energy(const RuntimeElement& e, Eigen::Index pose, const Eigen::Matrix3d& f)
{
    const Eigen::Matrix3d g = f.transpose() * f - Eigen::Matrix3d::Identity();
    const auto row = e.pose_numbers.row(pose);
    SymmetricVector six;
    six << g(0, 0), g(0, 1), g(0, 2), g(1, 1), g(1, 2), g(2, 2);
    if (e.kind == PLIANT_ELEMENT_TET_STVK) {
        double sum = row.head<6>().dot(six);
        Eigen::Index next = 6;
        for (int i = 0; i < 6; ++i)
            for (int j = i; j < 6; ++j, ++next) sum += (i == j ? 0.5 : 1.0) * row[next] * six[i] * six[j];
        return sum;
    }
    const auto matrix = [&](Eigen::Index first) { return symmetric(row.segment<6>(first).transpose()); };
    const Eigen::Matrix3d a = matrix(6), b = matrix(12), metric = f.transpose() * f;
    const double s = f.determinant(), bulk = row[18], pressure = row[19];
    const auto whole = [&](const Eigen::Matrix3d& m, double j) {
        return std::pow(j, -2.0 / 3) * a.cwiseProduct(m).sum()
            + std::pow(j, -4.0 / 3) * b.cwiseProduct(m.determinant() * m.inverse()).sum() + bulk * j * j
            - 2 * (bulk - pressure) * j;
    };
    return whole(metric, s) - whole(Eigen::Matrix3d::Identity(), 1);
}

} // namespace

TEST_CASE("the runtime's tetrahedra have the energy of the baker's, relative to the reference")
{
    for_all_cases([](const golden::SolidCase& c, const NormalizedPoses& set, const Solid& solid) {
        Shape reference = 0.5 * (set.shapes[0] + set.shapes[1]), y = set.shapes[1] + 0.05 * vector(c.direction);
        for (std::size_t t = 0; t < set.tets.size(); ++t) {
            const RuntimeElement e = solid.runtime_element(t, reference);
            const Eigen::Matrix3d f = tet_edges(y, set.tets[t]) * e.combination;
            if (f.determinant() <= 0 || tet_edges(reference, set.tets[t]).determinant() <= 0) continue;
            std::size_t count = 0;
            const std::uint32_t* v = solid.element_vertices(t, count);
            for (std::size_t k = 0; k < 2; ++k) {
                const Weights w = corner_weights(2, k);
                double x[12], x0[12];
                gather(v, 4, y, x);
                gather(v, 4, reference, x0);
                ElementResult here, there;
                solid.evaluate(t, w.data(), x, Order::value, HessianKind::exact, here);
                solid.evaluate(t, w.data(), x0, Order::value, HessianKind::exact, there);
                CHECK(runtime_energy(e, Eigen::Index(k), f)
                      == doctest::Approx(here.value - there.value).epsilon(1e-10).scale(std::abs(here.value)));
                // L is the slope at the reference: the derivative by the metric there.
                const double h = 1e-6;
                Eigen::Matrix3d stretched = Eigen::Matrix3d::Identity();
                stretched(0, 0) += h;
                CHECK(std::abs(runtime_energy(e, Eigen::Index(k), stretched) - 2 * h * e.pose_numbers(Eigen::Index(k), 0))
                      < 1e-10);
            }
        }
    });
}

TEST_CASE("the quartic is the energy of the mesh, to 1e-12, in any coordinates")
{
    const NormalizedPoses set = normalize(twisted_bar(2, 6, 1.5));
    const Solid solid(set, {});
    Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(set.dof_count(), 4);
    for (Eigen::Index j = 0; j < 4; ++j)
        for (Eigen::Index i = 0; i < directions.rows(); ++i)
            directions(i, j) = std::sin(double(i * (j + 2)) * 0.7 + double(j));
    const Subspace subspace = build_subspace(set, directions, 5);
    const Quartic full(solid, subspace, nullptr);
    const Weights w = Eigen::Vector2d(0.3, 0.7);
    for (Eigen::Index d : { Eigen::Index(5), Eigen::Index(3) }) {
        const Quartic quartic = full.leading(d);
        const Subspace part = leading(subspace, d);
        Eigen::VectorXd q(d);
        for (Eigen::Index i = 0; i < d; ++i) q[i] = 0.3 * std::cos(double(i) + 1);
        Shape forces = Shape::Zero(set.dof_count());
        const double value = add_gradient(solid, w, part.shape(q), forces);
        Eigen::VectorXd gradient;
        CHECK(quartic.gradient(w, q, gradient) == doctest::Approx(value).epsilon(1e-12));
        CHECK(quartic.value(w, q) == doctest::Approx(value).epsilon(1e-12));
        CHECK(relative(gradient, part.basis.transpose() * forces) < 1e-12);
        HessianAssembler assembler(solid);
        assembler.assemble(w, part.shape(q), HessianKind::exact);
        const Eigen::MatrixXd reduced
            = part.basis.transpose() * (assembler.matrix().selfadjointView<Eigen::Lower>() * part.basis);
        CHECK((quartic.hessian(w, q) - reduced).norm() < 1e-12 * reduced.norm());

        // Other coordinates, and the coefficients of the asset: a plain sum over all monomials.
        const Eigen::VectorXd mean = 0.1 * q;
        const Eigen::MatrixXd root = Eigen::MatrixXd::Identity(d, d) + 0.1 * Eigen::MatrixXd::Ones(d, d);
        const Eigen::VectorXd z = root.inverse() * (q - mean);
        const Quartic moved = quartic.transformed(mean, root);
        CHECK(moved.value(w, z) == doctest::Approx(value).epsilon(1e-11));
        const Eigen::Index n = d + 1, pairs = n * (n + 1) / 2, padded = (pairs + 7) / 8 * 8;
        Eigen::VectorXd x(n);
        x << 1, z;
        double sum = 0;
        for (std::size_t k = 0; k < 2; ++k) {
            const Eigen::VectorXd c = moved.coefficients(k);
            Eigen::Index at = 0;
            for (Eigen::Index j = 0; j < n; ++j)
                for (Eigen::Index i = 0; i <= j; ++i) {
                    const Eigen::Index skipped = pair_index(j, j, n) / 8 * 8;
                    for (Eigen::Index a = 0; a < n; ++a)
                        for (Eigen::Index b = a; b < n; ++b) {
                            const Eigen::Index place = pair_index(a, b, n) - skipped;
                            if (place < 0) continue;
                            if (a < j) CHECK(c[at + place] == 0);
                            sum += w[Eigen::Index(k)] * c[at + place] * x[i] * x[j] * x[a] * x[b];
                        }
                    at += padded - skipped;
                }
            CHECK(at == c.size());
        }
        const double constant = quartic.value(w, mean);
        CHECK(sum == doctest::Approx(value - constant).epsilon(1e-11));
    }
}

TEST_CASE("the twisted bar of the paper's Table II has the independent energies")
{
    struct Expected {
        double angle;
        SolidLaw law;
        double straight_to_twisted, twisted_to_straight, average;
    };
    const double pi = 3.14159265358979323846;
    const Expected all[] = {
        { pi / 2, SolidLaw::stvk, 0.013118236474556332, 0.013149064825127586, 0.003198803715820553 },
        { pi, SolidLaw::stvk, 0.056135556769571854, 0.05663897203156492, 0.012744637797822613 },
        { pi / 2, SolidLaw::mooney_rivlin, 0.012372683840458965, 0.01237131946409388, 0.0030913963730712915 },
        { pi, SolidLaw::mooney_rivlin, 0.049511209996674965, 0.049489380178316736, 0.012349465581982565 },
    };
    for (const Expected& expected : all) {
        const PoseSet bar = twisted_bar(8, 48, expected.angle);
        CHECK(bar.vertex_count() == 3969);
        CHECK(bar.tets.size() == 15360);
        const NormalizedPoses set = normalize(bar, true);
        const Solid solid(set, { expected.law, -1 });
        const double unit = std::pow(set.length, 3);
        CHECK(unit * energy_value(solid, corner_weights(2, 0), set.shapes[1])
              == doctest::Approx(expected.straight_to_twisted).epsilon(1e-10));
        CHECK(unit * energy_value(solid, corner_weights(2, 1), set.shapes[0])
              == doctest::Approx(expected.twisted_to_straight).epsilon(1e-10));
        NewtonSolver solver(solid, set, default_solver());
        const NewtonResult mean = solver.minimize(equal_weights(2), set.shapes[0], {});
        CHECK(mean.has_converged);
        CHECK(unit * mean.energy == doctest::Approx(expected.average).epsilon(1e-6));
    }
}
