// Shapes of layers: exact where the layers fit together, defined everywhere else.
#include "../layered_bodies.h"
#include "bake/make_energy.h"
#include "elastic/average/family.h"
#include "elastic/average/shape_error.h"
#include "elastic/parts/tied_energy.h"

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
