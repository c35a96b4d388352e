// Whole bakes of a small tube, looked at through the C runtime.
#include "tube.h"

#include "average/family.h"
#include "average/shape_error.h"
#include "bake.h"
#include "io/write_file.h"
#include "report/certificate.h"
#include "subspace/krylov.h"
#include "write/runtime_blender.h"

#include <doctest/doctest.h>
#include <fmt/core.h>
#include <string>

using namespace pliant;

namespace {

struct Variant {
    const char* name;
    BakeOptions options;
    double error; // largest relative L2 allowed against the unreduced average
};

std::vector<Variant> variants()
{
    BakeOptions shells;
    shells.subspace = SubspaceKind::krylov;
    shells.ritz_count = 1;
    std::vector<Variant> out
        = { { "neo_hookean", shells, 0.02 }, { "stvk", shells, 0.02 }, { "edge", shells, 0.02 },
            { "arap", shells, 0.02 },        { "ghost", shells, 0.2 }, { "adaptive", BakeOptions(), 3e-3 } };
    out[1].options.energy.shell.membrane = Membrane::stvk;
    out[2].options.energy.shell.membrane = Membrane::edge;
    out[3].options.energy.material = Material::arap;
    out[4].options.stand_in = StandInKind::ghost;
    out[4].options.ghost_vertex_count = 120;
    return out;
}

double relative(const std::vector<float>& a, const Positions& b)
{
    double difference = 0, size = 0;
    for (Eigen::Index v = 0; v < b.rows(); ++v) {
        difference += (Eigen::Map<const Eigen::RowVector3f>(a.data() + 3 * v).cast<double>() - b.row(v)).squaredNorm();
        size += b.row(v).squaredNorm();
    }
    return std::sqrt(difference / size);
}

// Leaves the asset and the runtime's answers for the script beside this test, which holds them against the second implementation.
void write_for_reference(const std::string& name, const BakedAsset& baked, RuntimeBlender& blender)
{
    write_file_atomically("tube_" + name + ".pliant",
                          { reinterpret_cast<const char*>(baked.bytes.data()), baked.bytes.size() });
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.tolerance = 1e-5f;
    blender.configure(desc);
    std::string text;
    for (const std::vector<float>& w : { std::vector<float> { 1, 1, 1 }, { 0.2f, 0.7f, 0.1f }, { 0, 1, 3 } }) {
        for (float value : w) text += std::to_string(value) + " ";
        for (float value : blender.positions(blender.solve(w, false))) text += fmt::format("{:.9g} ", value);
        text += "\n";
    }
    write_file_atomically("tube_" + name + ".txt", text);
}

} // namespace

TEST_CASE("every material bakes to an asset whose blends are near the unreduced average")
{
    const PoseSet poses = tube_poses(3);
    for (const Variant& variant : variants()) {
        CAPTURE(variant.name);
        Progress silent;
        const BakedAsset baked = bake(poses, variant.options, silent);
        for (const auto& check : baked.report.checks) {
            CHECK(check.has_converged);
            CHECK(check.error.relative_l2 < variant.error);
        }
        CHECK(baked.report.runtime_error < 1e-5); // C runtime against double precision, at the training weights
        RuntimeBlender blender(baked.bytes, variant.name);
        write_for_reference(variant.name, baked, blender);
        for (std::size_t k = 0; k < 3; ++k) { // a pose alone is reproduced: aligned to pose 0, in input units
            std::vector<float> w(3, 0.f);
            w[k] = 1;
            const ShapeSet set = normalise(poses);
            CHECK(relative(blender.positions(blender.solve(w, false)), to_input_units(set, set.shapes[k])) < 2e-5);
        }
        const EnergyOptions read = read_energy_options(blender.certificate(), variant.name);
        CHECK(read.material == variant.options.energy.material);
        CHECK(read.shell.membrane == variant.options.energy.shell.membrane);
    }
}

TEST_CASE("the adaptive subspace meets its tolerance with fewer dimensions than Algorithm 1 at larger error")
{
    const ShapeSet set = normalise(tube_poses(3));
    const DiscreteShells energy(set, ShellOptions());
    SolverPool pool(energy, set, default_solver());
    NewtonOptions newton;
    newton.decrement = 1e-5;
    AverageFamily family(pool, newton, nullptr);
    Random random(5);
    std::vector<Weights> weights;
    for (std::size_t i = 0; i < 9; ++i) weights.push_back(mixed_weights(random, 3, i));
    HessianAssembler assembler(energy);
    assembler.assemble(equal_weights(3), family.mean().y, HessianKind::exact);
    const auto error_of = [&](const AdaptiveSubspace& built) {
        return subspace_error(ReducedSolver(energy, built.subspace, assembler.matrix(), family.mean().energy), set,
                              built.checks);
    };
    AdaptiveOptions options;
    AdaptiveReport report;
    const AdaptiveSubspace a = build_adaptive_subspace(family, pool, weights, options, nullptr, report);
    CHECK(error_of(a).mean < 1e-3);
    options.tolerance = 1e-4;
    const AdaptiveSubspace b = build_adaptive_subspace(family, pool, weights, options, nullptr, report);
    CHECK(error_of(b).mean < 1e-4);
    CHECK(error_of(b).largest < 3e-4);
    CHECK(report.unconverged_count == 0);
    CHECK(a.subspace.dimension() < b.subspace.dimension());
    CHECK(b.subspace.dimension() < 20);
    options.tolerance = 1; // met at once: a dimension that is asked for is filled all the same
    options.dimension = 9;
    const AdaptiveSubspace c = build_adaptive_subspace(family, pool, weights, options, nullptr, report);
    CHECK(c.subspace.dimension() == 9);
    AdaptiveSubspace krylov;
    krylov.subspace = build_krylov_subspace(pool.at(0), { 2, 9, 256 }, nullptr);
    krylov.checks = c.checks;
    CHECK(10 * error_of(c).mean < error_of(krylov).mean);
}

TEST_CASE("all poses lead to one average, and a branch is known by its energy")
{
    const ShapeSet set = normalise(tube_poses(3));
    const DiscreteShells energy(set, ShellOptions());
    SolverPool pool(energy, set, default_solver());
    AverageFamily family(pool, NewtonOptions(), nullptr), same(pool, NewtonOptions(), nullptr, 2);
    CHECK(family.mean().has_converged);
    CHECK(family.findings().empty());
    CHECK(same.start_pose() == 2);
    CHECK(relative_distance(set, same.mean().y, family.mean().y) < 1e-5);
    Weights w(3);
    w << 0.7, 0.1, 0.2;
    const FamilyPoint point = family.at(w, 0, nullptr);
    CHECK(point.jumps.empty());
    const CheckPoint check = family.check(w, set.shapes[1], 0, 0, nullptr); // from a far pose: the same minimum
    CHECK(relative_distance(set, check.truth, point.average.y) < 1e-4);
    CHECK(check.findings.empty());
    CHECK(check.error > 0.01);
}

TEST_CASE("a bake says what it measured, and the certificate holds it")
{
    Progress silent;
    BakeOptions options;
    options.check_count = 9;
    options.fresh_count = 3;
    const BakedAsset baked = bake(tube_poses(3), options, silent);
    const BakeReport& r = baked.report;
    CHECK(r.checks.size() == 12);
    CHECK(r.meets_tolerance);
    CHECK(r.mean_error < 1e-3);
    CHECK(r.stand_in.curvature.lowest > 0);
    CHECK(r.triangle_ratio > 0.1);
    CHECK(read_start_pose(r.certificate) == r.start_pose);
    CHECK(r.certificate.find("\"meets_tolerance\": true") != std::string::npos);
    options.tolerance_max = 1e-7; // below what single precision can do
    CHECK_FALSE(bake(tube_poses(3), options, silent).report.meets_tolerance);
}

TEST_CASE("the same bake gives the same bytes")
{
    const PoseSet poses = tube_poses(2);
    BakeOptions options;
    options.check_count = 1;
    Progress silent;
    CHECK(bake(poses, options, silent).bytes == bake(poses, options, silent).bytes);
}

TEST_CASE("scale and distance from the origin do not change the map from weights to shapes")
{
    const PoseSet poses = tube_poses(3);
    BakeOptions options;
    options.tolerance = 1e-4;
    options.check_count = 9;
    Progress silent;
    RuntimeBlender reference(bake(poses, options, silent).bytes, "reference");
    const std::vector<float> w = { 0.3f, 0.5f, 0.2f };
    const std::vector<float> expected = reference.positions(reference.solve(w, false));
    struct Change {
        double scale, offset;
    };
    for (const Change& change : { Change { 1e-3, 0 }, Change { 1e3, 0 }, Change { 1, 1200 }, Change { 1e3, 1.2e6 } }) {
        CAPTURE(change.scale);
        CAPTURE(change.offset);
        PoseSet changed = poses;
        const Eigen::RowVector3d offset(change.offset, -change.offset, 0.5 * change.offset);
        for (Positions& p : changed.positions) p = ((change.scale * p).rowwise() + offset).eval();
        RuntimeBlender blender(bake(changed, options, silent).bytes, "changed");
        const std::vector<float> q = blender.solve(w, false);
        const std::vector<float> got = blender.positions(q);
        double worst = 0;
        for (std::size_t i = 0; i < got.size(); ++i)
            worst = std::max(worst,
                             std::abs((double(got[i]) - offset[Eigen::Index(i % 3)]) / change.scale - double(expected[i])));
        // float32 positions far from the origin carry its spacing; the shape itself agrees to the solver's tolerance.
        CHECK(worst < 1e-4 + 2e-7 * std::abs(change.offset) / change.scale);
    }
}

TEST_CASE("two bakes that differ only in the rigid placement of a pose blend alike")
{
    PoseSet poses = tube_poses(2);
    BakeOptions options;
    options.check_count = 0;
    Progress silent;
    RuntimeBlender a(bake(poses, options, silent).bytes, "a");
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.0, Eigen::Vector3d(3, 1, 2).normalized()).toRotationMatrix();
    poses.positions[1] = ((poses.positions[1] * turn.transpose()).rowwise() + Eigen::RowVector3d(5, 5, 5)).eval();
    RuntimeBlender b(bake(poses, options, silent).bytes, "b");
    const std::vector<float> x = a.positions(a.solve({ 1, 2 }, false)), y = b.positions(b.solve({ 1, 2 }, false));
    for (std::size_t i = 0; i < x.size(); ++i) CHECK(std::abs(x[i] - y[i]) < 1e-4);
}
