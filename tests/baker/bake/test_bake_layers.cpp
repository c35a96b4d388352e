// Whole bakes of layers on small bodies, looked at through the C runtime.
#include "../for_reference.h"
#include "../layered_bodies.h"

#include "bake/bake.h"
#include "bake/make_energy.h"
#include "bake/warnings.h"
#include "base/mesh/align.h"
#include "base/weights/weights.h"
#include "elastic/average/corrected_family.h"
#include "elastic/average/shape_error.h"
#include "elastic/parts/drift.h"
#include "elastic/parts/find_ties.h"
#include "output/asset/runtime_blender.h"

#include <doctest/doctest.h>

using namespace pliant;

namespace {

BakeOptions layered_options(Material material = Material::discrete_shells, double low = 0, double high = 1)
{
    BakeOptions options;
    options.energy.blend = Blend::layers;
    options.energy.material = material;
    options.ranges = { { "", { low, high, 0 } } };
    return options;
}

BakedAsset bake_quietly(const PoseSet& poses, const BakeOptions& options)
{
    Progress silent;
    return bake(poses, options, silent);
}

// A sheet of 13 x 5 vertices with one layer for each half, which rolls up from an end of the sheet: the layers are not
// aligned, and combinations of them are nearly a rotation of the sheet.
PoseSet bent_sheet()
{
    PoseSet poses;
    Positions flat(65, 3), left, right;
    for (int v = 0; v < 65; ++v) flat.row(v) << v / 5, v % 5, 0;
    left = right = flat;
    for (int v = 0; v < 65; ++v) {
        const double x = flat(v, 0), radius = 4;
        const double beyond = std::max(x - 6, 0.0), before = std::max(6 - x, 0.0);
        right.row(v) << std::min(x, 6.0) + radius * std::sin(beyond / radius), flat(v, 1),
            radius * (1 - std::cos(beyond / radius));
        left.row(v) << std::max(x, 6.0) - radius * std::sin(before / radius), flat(v, 1),
            radius * (1 - std::cos(before / radius));
    }
    poses.blend = Blend::layers;
    poses.positions = { flat, left, right };
    poses.names = poses.paths = { "flat", "left", "right" };
    for (std::uint32_t i = 0; i < 12; ++i)
        for (std::uint32_t j = 0; j < 4; ++j) {
            const std::uint32_t a = 5 * i + j;
            poses.triangles.push_back({ a, a + 5, a + 6 });
            poses.triangles.push_back({ a, a + 6, a + 1 });
        }
    for (const Triangle& t : poses.triangles) {
        poses.polygons.indices.insert(poses.polygons.indices.end(), t.begin(), t.end());
        poses.polygons.offsets.push_back(std::uint32_t(poses.polygons.indices.size()));
    }
    return poses;
}

// A tube with a small eye at its surface, and four layers that turn the eye alone: by 60 degrees to both sides about two
// axes.
PoseSet small_eye()
{
    PartsMesh mesh;
    mesh.has_jacket = mesh.has_vertex = false;
    PoseSet poses = mesh.poses(1);
    const Eigen::Index first = Eigen::Index(tube_poses(1).vertex_count()), count = poses.positions[0].rows() - first;
    const Eigen::RowVector3d centre(0.15, 0, 4.5), place(0.45, 0, 4.5);
    const Eigen::MatrixX3d about = 0.2 * (poses.positions[0].bottomRows(count).rowwise() - centre);
    poses.blend = Blend::layers;
    poses.positions.assign(5, poses.positions[0]);
    for (int k = 0; k < 5; ++k) {
        const Eigen::Vector3d axis = k < 3 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
        const Eigen::AngleAxisd turn(k == 0 ? 0 : k % 2 ? 1.05 : -1.05, axis);
        poses.positions[std::size_t(k)].bottomRows(count) = (about * turn.matrix().transpose()).rowwise() + place;
    }
    poses.names = poses.paths = { "rest", "left", "right", "up", "down" };
    return poses;
}

const KindErrors* find_kind(const BakeReport& report, const std::string& kind)
{
    for (const KindErrors& errors : report.check.kinds)
        if (errors.kind == kind) return &errors;
    return nullptr;
}

} // namespace

TEST_CASE("layers bake to assets whose blends are near the unreduced shapes")
{
    struct Body {
        const char* name;
        PoseSet poses;
        Material material;
    };
    for (const Body& body :
         { Body { "tube", layered_tube(), Material::discrete_shells }, Body { "arap", layered_tube(), Material::arap },
           Body { "parts", layered_parts(), Material::discrete_shells } }) {
        CAPTURE(body.name);
        BakeOptions options = layered_options(body.material);
        options.tolerance = 3e-3;
        const BakedAsset baked = bake_quietly(body.poses, options);
        CHECK(baked.report.check.meets_tolerance);
        CHECK(baked.report.check.runtime_error < 1e-5);
        CHECK(baked.report.fit.dimension <= 16);
        for (const KindErrors& errors : baked.report.check.kinds) CHECK(errors.mean < 0.2 * errors.linear_mean);

        RuntimeBlender blender(baked.bytes, body.name);
        const NormalizedPoses set = normalize(body.poses, true);
        CHECK(blender.asset().weight_count == 2);
        for (std::size_t k = 0; k < 3 && !body.poses.render_mesh; ++k) { // poses come back in their place
            const std::vector<float> v = { k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f };
            const Shape shape = from_input_units(set, blender.positions(blender.solve(v, false)));
            CHECK((shape - set.shapes[k]).norm() < 5e-3 * set.shapes[k].norm());
        }
        write_for_reference(std::string("layers_") + body.name, baked, blender,
                            { { 1, 1 }, { 0.5f, 0.25f }, { 1.2f, -0.1f } });
    }
}

TEST_CASE("a miss of layers names the layers of the worst mixture, and no pose in between")
{
    BakeReport report;
    report.input.pose_names = { "rest", "smile", "blink", "frown" };
    report.input.ranges.resize(3);
    report.check.blends.resize(1);
    report.check.worst_weights = Eigen::Vector3d(1, 0, -0.25);
    BakeOptions options;
    const auto miss = [&] { return *find_miss(report, options, true); };
    CHECK(miss().what.find("mixtures of layers miss the tolerance") == 0);
    CHECK(miss().what.find("at weights smile=1,frown=-0.25") != std::string::npos);
    CHECK(miss().hint.find("pose") == std::string::npos);
    CHECK(miss().hint.find("--range") != std::string::npos);
    report.check.largest_error = 0.5;
    options.tolerance_max = 1; // is kept: the mean of the default is an aim all the same
    CHECK_FALSE(find_miss(report, options, false)->is_asked);
    options.tolerance_max = 0.1;
    CHECK(find_miss(report, options, false)->is_asked);
    options.tolerance_max = 0;
    report.fit.subspace_error.mean = 1;
    CHECK(miss().hint.find("--dim") == std::string::npos); // it was not given
    options.dimension = 4;
    CHECK(miss().hint.find("--dim") != std::string::npos);
    report.branches.push_back({ Branch::Kind::jump, report.check.worst_weights, 3, 0.1, 7 });
    CHECK(miss().hint.find("sums of layers jump (P4406): use --material arap") == 0);

    struct Told final : Progress {
        std::string what, hint;
        void warn(int, const std::string& w, const std::string& h) override { what = w, hint = h; }
    } told;
    PoseSet poses = layered_tube();
    poses.names = report.input.pose_names;
    poses.positions.resize(4, poses.positions[0]);
    warn_of_blends(report, poses, told);
    CHECK(told.what.find("the sum of layers jumps on the path towards layer frown: distance 10.0 %") == 0);
    CHECK(told.what.find("weights smile=1,frown=-0.25") != std::string::npos);
    CHECK(told.hint.find("pose") == std::string::npos);
    told.what.clear();
    warn_of_jumps({ {}, report.branches }, poses, Material::arap, "frame 3: ", told);
    CHECK(told.what.find("frame 3: the sum of layers jumps on the path towards layer frown") == 0);
    CHECK(told.hint == "take a smaller --range, or leave one of the layers out");
    CHECK(blend_text(Eigen::Vector3d::Zero(), poses.names) == "0");
    CHECK(blend_text(Eigen::Vector4d(1, 0, 0, 0), poses.names) == "1,0,0,0");
    const std::vector<std::string> many = { "rest", "a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l" };
    Weights all(12);
    all << 1, 2, 3, 4, 5, 6, 7, 8, 9, -10, 11, 0;
    CHECK(blend_text(all, many) == "k=11,j=-10,i=9,h=8,g=7,f=6 and 5 smaller ones");
    CHECK(blend_text(Eigen::VectorXd::Unit(13, 1), many) == "a=1"); // averages of many poses
}

TEST_CASE("a layer that grows a body is reached, or misses the tolerance")
{
    const BakeOptions options = layered_options(Material::discrete_shells);
    for (const double growth : { 20.0, 30.0, 100.0 }) {
        CAPTURE(growth);
        PoseSet poses = layered_tube();
        poses.positions = { poses.positions[0], growth * poses.positions[0] };
        poses.names.resize(2);
        poses.paths.resize(2);
        const BakedAsset baked = bake_quietly(poses, options);
        RuntimeBlender blender(baked.bytes, "grown");
        const NormalizedPoses set = normalize(poses, true);
        const Shape shape = from_input_units(set, blender.positions(blender.solve({ 1.0f }, false)));
        const double error = relative_error(set, shape, set.shapes[1]);
        CAPTURE(error);
        CHECK((error < options.tolerance) == (growth < 55)); // the most that the format holds
        CHECK((error < options.tolerance || !baked.report.check.meets_tolerance));
    }
}

TEST_CASE("the limit of the largest error holds at the poses, too")
{
    const PoseSet poses = tube_poses(3);
    const NormalizedPoses set = normalize(poses, true);
    BakeOptions options;
    options.tolerance = 1e-2;
    options.dimension = 16; // far more than the tolerance needs
    options.element_count = 200;
    options.position_error = 1e-3; // moves the poses more than what lies between them
    const BakedAsset baked = bake_quietly(poses, options);
    RuntimeBlender blender(baked.bytes, "coarse");
    double error = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        std::vector<float> w(3);
        w[k] = 1;
        Shape shape = from_input_units(set, blender.positions(blender.solve(w, false)));
        apply(best_rigid_motion(shape, set.shapes[k], set.masses), shape);
        error = std::max(error, relative_error(set, shape, set.shapes[k]));
    }
    CHECK(baked.report.check.meets_tolerance);
    REQUIRE(error > baked.report.check.largest_error);
    options.tolerance_max = 0.5 * (error + baked.report.check.largest_error);
    const CheckReport limited = bake_quietly(poses, options).report.check;
    CHECK_FALSE(limited.meets_tolerance);
    CHECK(limited.largest_error > options.tolerance_max);
}

TEST_CASE("ranges of layers beyond 0 to 1 are measured")
{
    BakeOptions options = layered_options(Material::discrete_shells, -0.5, 1.5);
    options.tolerance = 1e-2;
    const BakeReport report = bake_quietly(layered_tube(), options).report;
    CHECK(report.check.meets_tolerance);
    double low = 0, high = 0;
    for (const BlendCheck& check : report.check.blends) {
        low = std::min(low, check.weights.minCoeff());
        high = std::max(high, check.weights.maxCoeff());
    }
    CHECK(low < -0.2);
    CHECK(high > 1.2);
}

TEST_CASE("layers that turn a body as a whole leave no blend adrift")
{
    const BakeReport report = bake_quietly(bent_sheet(), layered_options(Material::discrete_shells, -0.5, 1.3)).report;
    for (const BlendCheck& check : report.check.blends) CHECK(check.error.relative_l2 < 2e-2);
}

TEST_CASE("a small part turns as far as its layers ask, although the error of the body hardly shows it")
{
    const PoseSet poses = small_eye();
    const BakedAsset baked = bake_quietly(poses, layered_options());
    const NormalizedPoses set = normalize(poses, true);
    const TieSet ties = find_ties(set);
    REQUIRE(ties.joints.size() == 1);
    RuntimeBlender blender(baked.bytes, "the test's asset");
    for (const Eigen::Vector4f& v : { Eigen::Vector4f(1, 0, 1, 0), Eigen::Vector4f(0, 1, 0, 1),
                                      Eigen::Vector4f(0.5f, 0, 0.5f, 0), Eigen::Vector4f(0, 0.6f, 0, 0.8f) }) {
        const Shape shape = from_input_units(set, blender.positions(blender.solve({ v[0], v[1], v[2], v[3] }, false)));
        CAPTURE(weights_text(v.cast<double>()));
        CHECK(measure_turn_drift(ties, v.cast<double>(), shape).largest < 0.1);
    }
}

TEST_CASE("layers whose sum is linear take no more dimensions than layers")
{
    PoseSet poses = layered_tube();
    for (std::size_t k = 1; k < 3; ++k)
        poses.positions[k] = poses.positions[0] + 0.02 * (poses.positions[k] - poses.positions[0]);
    const BakeReport report = bake_quietly(poses, layered_options()).report;
    CHECK(report.fit.dimension == 2);
    CHECK(report.check.meets_tolerance);
    CHECK(report.check.linear_error < 1e-3);
    REQUIRE(find_kind(report, "pair"));
    CHECK(find_kind(report, "pair")->linear_mean < 1e-3);
}

TEST_CASE("what a family of layers has learned saves factorisations, and changes no shape")
{
    const NormalizedPoses set = normalize(layered_tube(), true);
    const std::unique_ptr<Energy> energy = make_energy(set, layered_options().energy);
    SolverPool pool(*energy, set, default_solver());
    AverageFamily family(pool, NewtonOptions(), nullptr);
    CorrectedFamily known(family, nullptr);
    const WeightDomain domain = WeightDomain::box({ {}, {} });
    const std::vector<Weights> wanted = domain.draw_all(9, 6);
    const int before = pool.factorization_count();
    const std::vector<CheckPoint> first = known.find(wanted, { "averages", 0, 6 }, true);
    const int unguided = pool.factorization_count() - before;
    known.learn(known.find(domain.draw_all(1, 30), { "averages", 0, 30 }, true));
    const int learned = pool.factorization_count();
    const std::vector<CheckPoint> second = known.find(wanted, { "averages", 0, 6 }, true);
    CHECK(pool.factorization_count() - learned < unguided);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        CHECK(second[i].has_converged);
        CHECK(relative_distance(set, first[i].reference, second[i].reference) < 1e-5);
    }
}
