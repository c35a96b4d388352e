// Whole bakes of a small twisted bar, looked at through the C runtime.
#include "../for_reference.h"
#include "../twisted_bar.h"

#include "bake/certificate.h"
#include "bake/make_energy.h"
#include "base/common/diagnostics.h"
#include "base/mesh/tets.h"
#include "elastic/average/newton.h"
#include "elastic/energy/solid.h"

#include <algorithm>
#include <cstring>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

struct Variant {
    const char* name;
    BakeOptions options;
    SurrogateKind surrogate;
    bool is_held; // by the vertices of one end
};

std::vector<Variant> variants()
{
    BakeOptions stvk, cubature, mooney_rivlin;
    cubature.surrogate = SurrogateKind::cubature;
    mooney_rivlin.energy.material = Material::mooney_rivlin;
    return { { "bar_quartic", stvk, SurrogateKind::quartic, false },
             { "bar_stvk", cubature, SurrogateKind::cubature, false },
             { "bar_mooney_rivlin", mooney_rivlin, SurrogateKind::cubature, false },
             { "bar_held", stvk, SurrogateKind::quartic, true } };
}

// The vertices at z = 0, where the twist moves nothing once it is centred on the axis.
void hold_one_end(PoseSet& poses)
{
    for (Eigen::Index v = 0; v < poses.positions[0].rows(); ++v)
        if (poses.positions[0](v, 2) == 0) poses.fixed_vertices.push_back(std::uint32_t(v));
}

} // namespace

TEST_CASE("solids bake to assets whose blends are near the unreduced average")
{
    for (const Variant& variant : variants()) {
        CAPTURE(variant.name);
        PoseSet poses = twisted_bar(2, 10, 2.0);
        if (variant.is_held) hold_one_end(poses);
        Progress silent;
        const BakedAsset baked = bake(poses, variant.options, silent);
        const BakeReport& report = baked.report;
        CHECK(report.check.meets_tolerance);
        CHECK(report.fit.kind == variant.surrogate);
        CHECK((report.fit.element_count == 0) == (variant.surrogate == SurrogateKind::quartic));
        CHECK(report.check.cell_ratio > 0.5);
        for (const BlendCheck& check : report.check.blends) {
            CHECK(check.has_converged);
            CHECK(check.error.relative_l2 < 2e-3);
        }
        CHECK(report.check.runtime_error < 1e-5); // C runtime against double precision
        RuntimeBlender blender(baked.bytes, variant.name);
        write_for_reference(variant.name, baked, blender, { { 1, 1 }, { 0.2f, 0.8f }, { 0.9f, 0.1f } });
        const NormalizedPoses set = normalize(poses);
        for (std::size_t k = 0; k < 2; ++k) {
            std::vector<float> w(2, 0.f);
            w[k] = 1;
            CHECK(relative(blender.positions(blender.solve(w, false)), to_input_units(set, set.shapes[k])) < 1e-4);
        }
        const EnergyOptions read = read_energy_options(blender.certificate(), false, variant.name);
        CHECK(read.material == material_of(variant.options.energy, true));
        CHECK(read.fixed_vertices == poses.fixed_vertices);
    }
}

TEST_CASE("a preview of solids that are stretched and pressed by far trains on shapes that a solid can have")
{
    PoseSet poses = twisted_bar(2, 10, 2.0);
    const Positions rest = poses.positions[0];
    poses.positions = { rest, rest * Eigen::Vector3d(2, 2, 1).asDiagonal(), rest * Eigen::Vector3d(0.5, 1, 1).asDiagonal() };
    poses.names.push_back("pressed");
    poses.paths.push_back("pressed.msh");
    BakeOptions options;
    options.energy.material = Material::mooney_rivlin;
    make_preview(options, false);
    Progress silent;
    const BakedAsset baked = bake(poses, options, silent); // threw P5102: infinite energies of interpolated averages
    CHECK(baked.report.fit.subspace_error.mean < 0.1);
}

TEST_CASE("fixed vertices are exactly still in every blend")
{
    PoseSet poses = twisted_bar(2, 6, 1.5);
    hold_one_end(poses);
    BakeOptions options;
    options.fresh_count = 0;
    Progress silent;
    const BakedAsset baked = bake(poses, options, silent);
    RuntimeBlender blender(baked.bytes, "held");
    const std::vector<float> rest = blender.positions(blender.solve({ 1, 0 }, false));
    for (float w : { 0.1f, 0.5f, 0.77f }) {
        const std::vector<float> blend = blender.positions(blender.solve({ 1 - w, w }, false));
        for (std::uint32_t v : poses.fixed_vertices)
            CHECK(std::memcmp(&blend[3 * std::size_t(v)], &rest[3 * std::size_t(v)], 3 * sizeof(float)) == 0);
        CHECK(blend != rest);
    }
}

TEST_CASE("the average of poses that are held converges by the forces on free vertices alone")
{
    PoseSet poses = twisted_bar(2, 6, 1.5);
    hold_one_end(poses);
    const NormalizedPoses set = normalize(poses);
    const Solid solid(set, {});
    NewtonSolver solver(solid, set, default_solver());
    const NewtonResult mean = solver.minimize(equal_weights(2), set.shapes[0], {});
    CHECK(mean.has_converged);
    CHECK(mean.residual < 1e-6);
    for (std::uint32_t v : poses.fixed_vertices)
        CHECK(mean.y.segment<3>(3 * Eigen::Index(v)) == set.shapes[0].segment<3>(3 * Eigen::Index(v)));
}

TEST_CASE("materials and surrogate energies of the other sort are refused")
{
    Progress silent;
    const PoseSet poses = twisted_bar(1, 2, 0.5);
    BakeOptions options;
    const auto number_of = [&] {
        try {
            bake(poses, options, silent);
        } catch (const Failure& failure) {
            return failure.diagnostics()[0].number;
        }
        return 0;
    };
    options.energy.material = Material::arap;
    CHECK(number_of() == 1206);
    options.energy.material = Material::mooney_rivlin;
    options.surrogate = SurrogateKind::quartic;
    CHECK(number_of() == 1207);
    options.surrogate = SurrogateKind::ghost;
    CHECK(number_of() == 1208);
}

TEST_CASE("above 32 dimensions auto takes cubature and says why")
{
    Progress silent;
    BakeOptions options;
    options.subspace = SubspaceKind::krylov; // the family of two poses itself has fewer dimensions
    options.dimension = 33;
    options.check_count = options.fresh_count = 0;
    PoseSet poses = twisted_bar(2, 6, 1.5);
    // The bar and its twist look the same after quarter turns: as many directions as that only rounding would find.
    for (Eigen::Index v = 0; v < poses.positions[1].rows(); ++v) {
        const Eigen::RowVector3d p = poses.positions[1].row(v);
        poses.positions[1].row(v) += Eigen::RowVector3d(0.02 * p.z() * p.z(), 0.1 * p.x() * p.z(), 0.05 * p.x() * p.y());
    }
    const BakedAsset baked = bake(poses, options, silent);
    REQUIRE(baked.report.fit.dimension == 33);
    CHECK(baked.report.fit.kind == SurrogateKind::cubature);
    CHECK(baked.report.fit.reason.find("32") != std::string::npos);
}

TEST_CASE("blends with tetrahedra inside out are warned of")
{
    struct Listener : Progress {
        void warn(int number, const std::string&, const std::string&) override { numbers.push_back(number); }
        std::vector<int> numbers;
    } listener;
    // St. Venant-Kirchhoff softens under pressure: squashed to a twentieth, it lets tetrahedra through.
    PoseSet poses = twisted_bar(2, 6, 0);
    poses.positions[1].col(2) *= 0.05;
    BakeOptions options;
    options.subspace = SubspaceKind::krylov;
    options.dimension = 1;
    const BakedAsset baked = bake(poses, options, listener);
    CHECK(baked.report.check.cell_ratio <= 0);
    CHECK(std::count(listener.numbers.begin(), listener.numbers.end(), 4407) == 1);
}
