// Energies of layers: independent numbers, finite differences for every kind of element, and what they are at the poses.
#include "../../skip.h"
#include "../input/io/files.h"
#include "../layered_bodies.h"
#include "base/mesh/align.h"
#include "elastic/average/family.h"
#include "elastic/energy/arap.h"
#include "elastic/energy/metric_logarithm.h"
#include "elastic/energy/reinforced_shells.h"
#include "elastic/energy/solid.h"
#include "elastic/parts/find_ties.h"
#include "elastic/parts/tied_energy.h"

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

using namespace pliant;

namespace {

using Json = nlohmann::json;

// A list of numbers, or of lists of them.
Eigen::VectorXd vector(const Json& list)
{
    std::vector<double> numbers;
    for (const Json& item : list)
        for (const Json& number : item.is_array() ? item : Json::array({ item })) numbers.push_back(number.get<double>());
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), Eigen::Index(numbers.size()));
}

double relative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).norm() / b.norm(); }

// A tube with a bend of one third and a twist of another as layers, and numbers for it by another program in another
// language: energies and gradients at `y`, minimisers. Neo-Hookean with lambda = mu = 1, nothing damped. Null: not there.
Json golden_tube()
{
    std::ifstream file(pliant_test::data_folder() + "/../golden/layers_tube.json");
    return file ? Json::parse(file) : Json();
}

// As these numbers mean it: no alignment, no normalization.
NormalizedPoses raw_set(const Json& tube)
{
    NormalizedPoses set;
    for (const Json& face : tube["faces"]) set.triangles.push_back(face.get<Triangle>());
    for (const Json& pose : tube["poses"]) set.shapes.push_back(vector(pose));
    set.masses = Eigen::VectorXd::Zero(set.dof_count() / 3);
    for (const Shape& shape : set.shapes) set.masses += lumped_masses(shape, set.triangles) / double(set.pose_count());
    return set;
}

DiscreteShells golden_shells(const NormalizedPoses& set, const Json& tube)
{
    ShellOptions options;
    options.thickness = tube["thickness_absolute"];
    options.foldover_damping = 1;
    return DiscreteShells(set, options, Blend::layers);
}

Shape disturbed(const Shape& shape, double size)
{
    Shape out = shape;
    for (Eigen::Index i = 0; i < out.size(); ++i) out[i] += size * std::sin(1.7 * double(i * i % 97));
    return out;
}

struct Body {
    std::string name;
    NormalizedPoses set;
    std::unique_ptr<Energy> energy;
};

std::unique_ptr<Energy> shells(const NormalizedPoses& set, Membrane membrane)
{
    ShellOptions options;
    options.thickness = 0.05;
    options.membrane = membrane;
    return std::make_unique<DiscreteShells>(set, options, Blend::layers);
}

// With the ties, and with the joints that can replace them.
std::unique_ptr<Energy> tied(const NormalizedPoses& set, bool has_joints)
{
    TieSet ties = find_ties(set);
    for (Joint& joint : ties.joints) joint.is_used = has_joints;
    return tie_parts(shells(set, Membrane::neo_hookean), std::move(ties));
}

// One for every kind of element.
std::vector<Body> bodies()
{
    const NormalizedPoses tube = normalize(layered_tube({ 13, 8 })), bar = normalize(layered_bar()),
                          parts = normalize(layered_parts());
    std::vector<Body> out;
    const auto add = [&](const char* name, const NormalizedPoses& set, const auto& make) {
        out.push_back({ name, set, nullptr });
        out.back().energy = make(out.back().set);
    };
    for (const Membrane membrane : { Membrane::neo_hookean, Membrane::stvk, Membrane::edge })
        add("shells", tube, [&](const NormalizedPoses& set) { return shells(set, membrane); });
    add("arap", tube, [](const NormalizedPoses& set) { return std::make_unique<Arap>(set, Blend::layers); });
    add("reinforced", tube,
        [](const NormalizedPoses& set) { return std::make_unique<ReinforcedShells>(set, ShellOptions(), Blend::layers); });
    for (const SolidLaw law : { SolidLaw::stvk, SolidLaw::mooney_rivlin })
        add(law == SolidLaw::stvk ? "stvk" : "mooney-rivlin", bar, [&](const NormalizedPoses& set) {
            return std::make_unique<Solid>(set, SolidOptions { law, 0.3 }, Blend::layers);
        });
    add("ties", parts, [](const NormalizedPoses& set) { return tied(set, false); });
    return out;
}

const Weights inside = Eigen::Vector2d(0.7, 0.4), outside = Eigen::Vector2d(1.5, -0.5);

} // namespace

TEST_CASE("energies, gradients and minimizers of a shell equal the independent ones")
{
    const Json tube = golden_tube();
    if (tube.is_null()) PLIANT_SKIP("no golden/layers_tube.json beside the data: set PLIANT_DATA");
    const NormalizedPoses set = raw_set(tube);
    const DiscreteShells energy = golden_shells(set, tube);
    SolverPool pool(energy, set, SolverKind::eigen);
    NewtonOptions options;
    options.decrement = 1e-14;
    AverageFamily family(pool, options, nullptr);
    family.mean();
    CHECK(tube["cases"].size() == 4);
    for (const Json& c : tube["cases"]) {
        const Weights v = vector(c["layers"]);
        CAPTURE(weights_text(v));
        Shape gradient = Shape::Zero(set.dof_count());
        const double expected = c["energy"];
        CHECK(std::abs(add_gradient(energy, v, vector(tube["y"]), gradient) - expected) <= 1e-12 * expected);
        CHECK(relative(gradient, vector(c["gradient"])) < 1e-11);
        if (!c["converged"]) continue; // theirs
        const FamilyPoint point = family.at(v, 0, nullptr);
        CHECK(point.average.has_converged);
        Shape aligned = vector(c["minimiser"]);
        apply(best_rigid_motion(aligned, point.average.y, set.masses), aligned);
        CHECK(relative(point.average.y, aligned) < 1e-8);
    }
}

TEST_CASE("poses have no energy, and no forces")
{
    for (const Body& body : bodies()) {
        CAPTURE(body.name);
        CHECK(weight_count(*body.energy) == 2);
        for (std::size_t k = 0; k < 3; ++k) {
            Shape gradient = Shape::Zero(body.set.dof_count());
            CHECK(add_gradient(*body.energy, weights_of_pose(*body.energy, k), body.set.shapes[k], gradient) < 1e-22);
            CHECK(gradient.norm() < 1e-10);
        }
        CHECK(energy_value(*body.energy, inside, body.set.shapes[0]) > 1e-4);
    }
}

TEST_CASE("derivatives are those of the values, of every kind of element, inside and outside of the range")
{
    for (const Body& body : bodies())
        for (const Weights& v : { inside, outside }) {
            CAPTURE(body.name);
            const Shape y = disturbed(body.set.shapes[0], 0.01), direction = disturbed(Shape::Zero(y.size()), 0.3);
            const double step = 1e-6;
            Shape gradient = Shape::Zero(y.size()), plus = gradient, minus = gradient;
            add_gradient(*body.energy, v, y, gradient);
            const double up = add_gradient(*body.energy, v, y + step * direction, plus);
            const double down = add_gradient(*body.energy, v, y - step * direction, minus);
            CHECK(gradient.dot(direction) == doctest::Approx((up - down) / (2 * step)).epsilon(1e-6));
            HessianAssembler assembler(*body.energy);
            assembler.assemble(v, y, HessianKind::exact);
            const Shape product = assembler.matrix().selfadjointView<Eigen::Lower>() * direction;
            CHECK((product - (plus - minus) / (2 * step)).norm() < 1e-5 * product.norm());
        }
}

TEST_CASE("projected Hessians of elements have no negative eigenvalue")
{
    for (const Body& body : bodies()) {
        CAPTURE(body.name);
        const Shape y = disturbed(body.set.shapes[0], 0.02);
        ElementResult result;
        std::vector<double> x;
        for (std::size_t e = 0; e < body.energy->element_count(); e += 7) {
            std::size_t count = 0;
            const std::uint32_t* vertices = body.energy->element_vertices(e, count);
            x.resize(3 * count);
            gather(vertices, count, y, x.data());
            body.energy->evaluate(e, outside.data(), x.data(), Order::hessian, HessianKind::projected, result);
            const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(result.hessian).eigenvalues();
            CHECK(values[0] >= -1e-9 * std::abs(values[values.size() - 1]));
        }
    }
}

TEST_CASE("forces follow the weights")
{
    for (const Body& body : bodies()) {
        CAPTURE(body.name);
        const Shape y = disturbed(body.set.shapes[0], 0.01);
        const Eigen::Vector2d direction(0.8, -0.3);
        const double step = 1e-3;
        Shape plus = Shape::Zero(y.size()), minus = plus;
        add_gradient(*body.energy, inside + step * direction, y, plus);
        add_gradient(*body.energy, inside - step * direction, y, minus);
        const Shape expected = (plus - minus) / (2 * step);
        CHECK(relative(weight_forces(*body.energy, inside, y, direction), expected) < 1e-4);
    }
}

TEST_CASE("logarithms of metrics are undone by exponentials, of slivers, too")
{
    const Metric rest(1, 0.3, 0.5);
    for (const Metric& g : { rest, Metric(2, 0.6, 1), Metric(4, -1, 0.7), Metric(1, 1 - 1e-7, 1) }) {
        CHECK(relative(metric_exponential(rest, metric_logarithm(rest, g)), g) < 1e-14);
        CHECK(relative(metric_exponential(g, metric_logarithm(g, rest)), rest) < 1e-8);
    }
    CHECK(metric_logarithm(rest, 4 * rest).isApprox(Metric(std::log(4), 0, std::log(4)), 1e-14));
    const SymmetricVector c = (SymmetricVector() << 2, 0.3, -0.1, 1, 0.2, 0.4).finished();
    CHECK(symmetric_exponential(symmetric_logarithm(c)).isApprox(symmetric(c), 1e-14));
}

TEST_CASE("rest metrics are positive definite whatever the weights")
{
    const Metric rest(1, 0.3, 0.5), logarithm = metric_logarithm(rest, Metric(4, -1, 0.7));
    for (const double v : { -5.0, -1.0, 0.5, 3.0, 8.0 }) {
        const Metric g = metric_exponential(rest, v * logarithm);
        CHECK(g[0] > 0);
        CHECK(determinant(g) > 0);
    }
}

TEST_CASE("a hinge's rest angle leaves the range of half a turn, and the angle follows it")
{
    // Two triangles; each layer folds the second one by a quarter turn and more. Twice 2 rad is more than half a turn.
    NormalizedPoses set;
    set.triangles = { { 0, 1, 2 }, { 1, 0, 3 } };
    for (const double angle : { 0.0, 2.0 }) {
        Shape shape(12);
        shape << 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, -std::cos(angle), std::sin(angle);
        set.shapes.push_back(shape);
    }
    set.masses = Eigen::VectorXd::Constant(4, 0.25);
    ShellOptions options;
    options.thickness = 0.1;
    const DiscreteShells energy(set, options, Blend::layers);
    Shape folded = set.shapes[0];
    for (const double weight : { 1.5, 1.7, 2.0, -1.8 }) {
        folded.tail<2>() << -std::cos(2 * weight), std::sin(2 * weight);
        CHECK(energy_value(energy, Weights::Constant(1, weight), folded) < 1e-25);
    }
}
