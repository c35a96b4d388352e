// Shapes of layers: exact where the layers fit together, defined everywhere else.
#include "../layered_bodies.h"
#include "bake/make_energy.h"
#include "elastic/average/family.h"
#include "elastic/average/shape_error.h"
#include "elastic/energy/contradictions.h"
#include "elastic/parts/tied_energy.h"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

// A body with two layers and the family of its shapes.
struct Layered {
    Layered(const PoseSet& from, Material material, Continuity continuity = Continuity::automatic)
        : poses(from)
        , set(normalize(poses))
    {
        EnergyOptions options;
        options.blend = Blend::layers;
        options.material = material;
        options.continuity = continuity;
        energy = make_energy(set, options);
        pool = std::make_unique<SolverPool>(*energy, set, SolverKind::eigen);
        family = std::make_unique<AverageFamily>(*pool, NewtonOptions(), nullptr);
        family->mean();
    }

    NewtonResult at(double twist, double bend) { return family->at(Eigen::Vector2d(twist, bend), 0, nullptr).average; }

    // From the shape that is built by formula, with parts of the angles of both layers.
    double error(const Shape& y, double twist, double bend)
    {
        Shape exact = set.shapes[0];
        const Positions built = layered_positions(poses.positions[0], 1.5 * twist, 1.5 * bend);
        for (Eigen::Index v = 0; v < built.rows(); ++v)
            exact.segment<3>(3 * v) = (built.row(v).transpose() - set.centre) / set.length;
        return relative_distance(set, y, exact);
    }

    PoseSet poses;
    NormalizedPoses set;
    std::unique_ptr<Energy> energy;
    std::unique_ptr<SolverPool> pool;
    std::unique_ptr<AverageFamily> family;
};

} // namespace

TEST_CASE("layers that fit together compose exactly, whatever they rotate")
{
    std::size_t number = 0;
    for (const PoseSet& poses : { layered_tube(), layered_parts(), layered_bar() })
        for (const Material material :
             { Material::discrete_shells, Material::arap, Material::stvk, Material::mooney_rivlin }) {
            const bool is_of_solids = material == Material::stvk || material == Material::mooney_rivlin;
            if (is_of_solids != poses.is_solid()) continue;
            Layered body(poses, material);
            const NewtonResult sum = body.at(1, 1);
            CAPTURE(++number);
            CHECK(sum.has_converged);
            CHECK(sum.energy < 1e-15);
            CHECK(body.error(sum.y, 1, 1) < 1e-7);
        }
}

TEST_CASE("the poses are reproduced, and so is the rest shape")
{
    Layered body(layered_tube(), Material::discrete_shells);
    for (const auto& [twist, bend] : { std::pair(0.0, 0.0), { 1.0, 0.0 }, { 0.0, 1.0 } })
        CHECK(body.error(body.at(twist, bend).y, twist, bend) < 1e-9);
}

TEST_CASE("parts of layers, exaggerations and opposites are near the shapes that are meant")
{
    Layered body(layered_tube(), Material::discrete_shells, Continuity::off);
    for (const auto& [twist, bend] : { std::pair(0.5, 0.5), { 1.5, -0.5 }, { -0.5, -0.5 }, { 2.0, 0.0 } }) {
        const NewtonResult shape = body.at(twist, bend);
        CHECK(shape.has_converged);
        CHECK(body.error(shape.y, twist, bend) < 0.05);
    }
}

TEST_CASE("fixed vertices stay")
{
    PoseSet poses = layered_tube();
    for (std::uint32_t v = 0; v < 10; ++v) poses.fixed_vertices.push_back(v); // the lowest ring, at rest in both layers
    Layered body(poses, Material::discrete_shells);
    for (const auto& [twist, bend] : { std::pair(1.0, 1.0), { 0.5, -0.5 } }) {
        const NewtonResult shape = body.at(twist, bend);
        CHECK(shape.has_converged);
        CHECK(shape.y.head<30>() == body.set.shapes[0].head<30>());
        if (twist == 1) CHECK(body.error(shape.y, 1, 1) < 1e-7);
    }
}

namespace {

// The straight tube, and that with the sphere in it turned by `angle` about a skew axis through its centre.
PoseSet turned_sphere(double angle)
{
    PartsMesh mesh;
    mesh.body = { 13, 8 };
    mesh.has_jacket = mesh.has_vertex = false;
    PoseSet poses = mesh.poses(1);
    Positions turned = poses.positions[0];
    const Eigen::Vector3d centre(0.15, 0, 4.5), axis = Eigen::Vector3d(0.2, 1, 0).normalized();
    for (Eigen::Index v = 13 * 8 + 2; v < turned.rows(); ++v)
        turned.row(v) = centre + Eigen::AngleAxisd(angle, axis) * (turned.row(v).transpose() - centre);
    poses.positions.push_back(turned);
    poses.names = { "straight", "turned" };
    poses.paths = poses.names;
    return poses;
}

} // namespace

TEST_CASE("half of a layer that turns a part turns it half way")
{
    Layered body(turned_sphere(1.0), Material::discrete_shells);
    REQUIRE(ties_of(*body.energy)->joints.size() == 1);
    const NewtonResult half = body.family->at(Weights::Constant(1, 0.5), 0, nullptr).average;
    CHECK(half.has_converged);
    const Positions expected = turned_sphere(0.5).positions[1];
    double largest = 0;
    for (Eigen::Index v = 0; v < expected.rows(); ++v) {
        const Eigen::Vector3d exact = (expected.row(v).transpose() - body.set.centre) / body.set.length;
        largest = std::max(largest, (half.y.segment<3>(3 * v) - exact).norm());
    }
    CHECK(largest < 5e-4 * body.set.diagonal);
}

TEST_CASE("where there is no shape the search ends and says so")
{
    for (const Material material : { Material::discrete_shells, Material::arap }) {
        Layered body(layered_tube({ 13, 8 }), material);
        for (const double far : { 1e6, 1e300 }) {
            CHECK_FALSE(body.at(far, -far).has_converged);
            CHECK(body.pool->factorization_count() < 500);
        }
    }
    Layered solid(layered_bar(), Material::mooney_rivlin);
    CHECK_FALSE(solid.at(1e3, 0).has_converged);
    CHECK(solid.at(1, 0).has_converged); // nothing of it stays behind
}

namespace {

// A strip of eight triangles; each pose is the strip folded at its middle edge by an angle.
PoseSet folded_strip(const std::vector<double>& angles)
{
    PoseSet poses;
    for (double angle : angles) {
        Positions places(10, 3);
        for (Eigen::Index v = 0; v < 10; ++v) {
            const double x = double(v / 2) - 2, y = double(v % 2), beyond = std::max(x, 0.0);
            places.row(v) << std::min(x, 0.0) + beyond * std::cos(angle), y, beyond * std::sin(angle);
        }
        poses.positions.push_back(places);
        poses.names.push_back("fold" + std::to_string(poses.names.size()));
    }
    for (std::uint32_t i = 0; i < 4; ++i) {
        poses.triangles.push_back({ 2 * i, 2 * i + 2, 2 * i + 3 });
        poses.triangles.push_back({ 2 * i, 2 * i + 3, 2 * i + 1 });
    }
    return poses;
}

} // namespace

TEST_CASE("layers that fold an edge through together contradict each other, smaller folds and apart ones do not")
{
    const NormalizedPoses set = normalize(folded_strip({ 0, 1.0, 2.0, 1.8, -1.9 }), true);
    const std::vector<Contradiction> pairs = find_contradictions(set);
    REQUIRE(pairs.size() == 1);
    CHECK(pairs[0].first == 2);
    CHECK(pairs[0].second == 3);
    CHECK(pairs[0].folded_edge_count == 1);
    CHECK(pairs[0].stretched_face_count == 0);
    CHECK((pairs[0].vertex == 4 || pairs[0].vertex == 5));
    CHECK(find_contradictions(normalize(layered_bar(), true)).empty());
    CHECK(find_contradictions(normalize(layered_tube(), true)).empty());
}
