// Whole bakes of a small tube, looked at through the C runtime.
#include "../for_reference.h"
#include "../tube.h"

#include "bake/bake.h"
#include "bake/certificate.h"
#include "bake/make_energy.h"
#include "bake/warnings.h"
#include "base/common/memory.h"
#include "base/weights/sampling.h"
#include "elastic/average/interpolated_family.h"
#include "elastic/average/shape_error.h"
#include "elastic/energy/reinforced_shells.h"
#include "input/io/write_file.h"
#include "output/asset/runtime_blender.h"
#include "reduced/subspace/adaptive.h"
#include "reduced/subspace/krylov.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <fmt/core.h>
#include <string>
#include <sys/resource.h>

using namespace pliant;

namespace {

struct Variant {
    const char* name;
    BakeOptions options;
    double error; // largest relative L2 allowed against the unreduced average
};

// The averages of a bent tube, with Newton's default accuracy.
struct TubeFamily {
    explicit TubeFamily(std::size_t pose_count)
        : set(normalize(tube_poses(pose_count)))
        , energy(set, ShellOptions())
        , pool(energy, set, default_solver())
        , family(pool, NewtonOptions(), nullptr)
    {
    }
    NormalizedPoses set;
    DiscreteShells energy;
    SolverPool pool;
    AverageFamily family;
};

// Mean relative L2 of linear blends of the tube at the weights of a report: what a bake must beat.
double linear_error(TubeFamily& tube, const CheckReport& report)
{
    tube.family.mean();
    double sum = 0;
    for (const BlendCheck& check : report.blends) {
        Shape blend = Shape::Zero(tube.set.dof_count());
        for (std::size_t k = 0; k < tube.set.pose_count(); ++k) blend += check.weights[Eigen::Index(k)] * tube.set.shapes[k];
        sum += relative_distance(tube.set, blend, tube.family.at(check.weights, 0, nullptr).average.y);
    }
    return sum / double(report.blends.size());
}

std::vector<Variant> variants()
{
    BakeOptions shells;
    shells.fresh_count = 4;
    shells.energy.material = Material::discrete_shells;
    shells.subspace = SubspaceKind::krylov;
    shells.ritz_count = 1;
    std::vector<Variant> out
        = { { "neo_hookean", shells, 5e-3 }, { "stvk", shells, 5e-3 },  { "edge", shells, 5e-3 },
            { "arap", shells, 5e-3 },        { "ghost", shells, 5e-3 }, { "adaptive", BakeOptions(), 3e-3 } };
    out[1].options.energy.shell.membrane = Membrane::stvk;
    out[2].options.energy.shell.membrane = Membrane::edge;
    out[3].options.energy.material = Material::arap;
    out[4].options.surrogate = SurrogateKind::ghost;
    out[4].options.ghost_vertex_count = 120;
    return out;
}

} // namespace

// Where bakes have looked, with room: weights that were not among them stay inside [0,1].
static void check_morph_ranges(RuntimeBlender& blender)
{
    const std::uint32_t m = blender.asset().pose_count, d = blender.asset().dimension;
    REQUIRE(blender.asset().morph_ranges);
    std::vector<float> pose_weights(m), morph(d);
    for (std::uint32_t i = 0; i < 40; ++i) {
        for (std::uint32_t k = 0; k < m; ++k) pose_weights[k] = float((7 * i + 3 * k * i) % 41) + (k == i % m ? 1.0f : 0.0f);
        const std::vector<float> q = blender.solve(pose_weights, false);
        REQUIRE(pliant_morph_weights(&blender.asset(), q.data(), morph.data()) == PLIANT_OK);
        for (float w : morph) CHECK((w >= 0 && w <= 1));
    }
}

TEST_CASE("every material bakes to an asset whose blends are near the unreduced average")
{
    const PoseSet poses = tube_poses(3);
    TubeFamily tube(3);
    for (const Variant& variant : variants()) {
        CAPTURE(variant.name);
        Progress silent;
        const BakedAsset baked = bake(poses, variant.options, silent);
        CHECK(baked.report.check.mean_error < 0.25 * linear_error(tube, baked.report.check));
        for (const auto& check : baked.report.check.blends) {
            CHECK(check.has_converged);
            CHECK(check.error.relative_l2 < variant.error);
        }
        CHECK(baked.report.check.runtime_error < 1e-5); // C runtime against double precision, at the training weights
        RuntimeBlender blender(baked.bytes, variant.name);
        check_morph_ranges(blender);
        write_for_reference(std::string("tube_") + variant.name, baked, blender,
                            { { 1, 1, 1 }, { 0.2f, 0.7f, 0.1f }, { 0, 1, 3 } });
        // A pose alone is reproduced, aligned to pose 0, in input units: to the position error of 5e-5.
        for (std::size_t k = 0; k < 3; ++k) {
            std::vector<float> w(3, 0.f);
            w[k] = 1;
            const NormalizedPoses set = normalize(poses);
            CHECK(relative(blender.positions(blender.solve(w, false)), to_input_units(set, set.shapes[k])) < 1e-4);
        }
        const EnergyOptions read = read_energy_options(blender.certificate(), false, variant.name);
        CHECK(read.material == material_of(variant.options.energy, false));
        CHECK(read.shell.membrane == variant.options.energy.shell.membrane);
        if (read.material == Material::discrete_shells) CHECK(read.continuity == variant.options.energy.continuity);
    }
}

TEST_CASE("fixed vertices of a surface are exactly still in every blend")
{
    PoseSet poses = tube_poses(2);
    poses.fixed_vertices = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9 }; // the first ring, where bending moves nothing
    for (std::uint32_t v : poses.fixed_vertices) poses.positions[1].row(v) = poses.positions[0].row(v);
    Progress silent;
    const BakedAsset baked = bake(poses, BakeOptions(), silent);
    CHECK(baked.report.check.meets_tolerance);
    CHECK(read_energy_options(baked.report.certificate, false, "held").fixed_vertices == poses.fixed_vertices);
    RuntimeBlender blender(baked.bytes, "held");
    const std::vector<float> rest = blender.positions(blender.solve({ 1, 0 }, false));
    for (float w : { 0.1f, 0.5f, 0.77f, 1.0f }) {
        const std::vector<float> blend = blender.positions(blender.solve({ 1 - w, w }, false));
        const std::size_t held = 3 * poses.fixed_vertices.size();
        CHECK(std::equal(blend.begin(), blend.begin() + std::ptrdiff_t(held), rest.begin()));
        for (std::size_t i = held; i < held + 30; i += 3) CHECK(blend[i] != rest[i]); // the next ring follows
    }
}

TEST_CASE("the origin is what the runtime adds: single precision")
{
    PoseSet poses = tube_poses(3);
    for (Positions& positions : poses.positions) positions.rowwise() += Eigen::RowVector3d(0.1, 1.0 / 3, -7.7);
    const NormalizedPoses set = normalize(poses);
    for (int c = 0; c < 3; ++c) { // by a variable that no compiler looks through
        volatile float single = float(set.centre[c]);
        CHECK(set.centre[c] == double(single));
    }
}

TEST_CASE("the adaptive subspace converges in d, far below Algorithm 1, and fills a dimension that was asked for")
{
    const NormalizedPoses set = normalize(tube_poses(3));
    const DiscreteShells energy(set, ShellOptions());
    SolverPool pool(energy, set, default_solver());
    NewtonOptions newton;
    newton.decrement = 1e-5;
    AverageFamily family(pool, newton, nullptr);
    Random random(5);
    std::vector<Weights> weights;
    for (std::size_t i = 0; i < 9; ++i) weights.push_back(mixed_weights(random, 3, i));
    family.mean();
    InterpolatedFamily known(family, nullptr), known_less(family, nullptr);
    AdaptiveOptions options;
    options.tolerance = 1e-4;
    const FoundSubspace found = build_adaptive_subspace(known, training_weights(3, 40, 1), weights, options, nullptr);
    CHECK(found.unconverged_count == 0);
    CHECK(found.checks.size() == weights.size());
    CHECK(found.averages.size() == 40);
    CHECK(found.interpolated_count() == 40 - 1 - known.learned_count());
    const auto error_of = [&](const Subspace& subspace) { return subspace_error(subspace, set, found.checks); };
    const SubspaceError few = error_of(leading(found.subspace, 9)), many = error_of(leading(found.subspace, 16));
    CHECK(few.mean < 1e-3);
    CHECK(many.mean < 1e-4);
    CHECK(many.largest < 3e-4);
    CHECK(10 * few.mean < error_of(build_krylov_subspace(pool.at(0), { 2, 9, 256 }, nullptr)).mean);

    options.dimension = 18;
    const FoundSubspace filled = build_adaptive_subspace(known_less, training_weights(3, 4, 1), weights, options, nullptr);
    CHECK(filled.subspace.dimension() == 18);
    options.tolerance = 1;
    InterpolatedFamily known_least(family, nullptr);
    const FoundSubspace coarse = build_adaptive_subspace(known_least, training_weights(3, 40, 1), weights, options, nullptr);
    CHECK(known_least.learned_count() == 5); // one wave
    CHECK(coarse.interpolated_count() == 34);
}

TEST_CASE("training weights are spread over the simplex, the equal ones first")
{
    for (std::size_t m : { 2, 3, 5, 12 }) {
        CAPTURE(m);
        const std::vector<Weights> weights = training_weights(m, 40, 7);
        REQUIRE(weights.size() == 40);
        CHECK((weights[0] - equal_weights(m)).norm() < 1e-15);
        double nearest = 1;
        std::size_t edge_count = 0;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            CHECK(std::abs(weights[i].sum() - 1) < 1e-12);
            CHECK(weights[i].minCoeff() >= 0);
            edge_count += (weights[i].array() > 0).count() == 2;
            for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (weights[i] - weights[j]).norm());
        }
        CHECK(nearest > 0.01);
        if (m <= 5) CHECK(edge_count >= 5); // twelve poses have 66 edges, and inner weights are farther from all poses
    }
}

TEST_CASE("averages next to others or to poses are no training data of their own")
{
    TubeFamily tube(2);
    auto& [set, energy, pool, family] = tube;
    const Shape& mean = family.mean().y;
    const Subspace subspace = build_subspace(set, mean - set.shapes[0], 2);
    const ReducedSolver reduced(energy, subspace, family.mean_hessian(), family.mean().energy);
    const Weights other = Eigen::Vector2d(0.3, 0.7), near = Eigen::Vector2d(0.5001, 0.4999),
                  corner = Eigen::Vector2d(0.0001, 0.9999);
    const std::vector<KnownAverage> known
        = { { equal_weights(2), mean }, { near, mean }, { corner, mean }, { other, set.shapes[1] } };
    const std::vector<ProjectedAverage> averages
        = AverageProjector(energy, subspace, set, nullptr).project(distinct_averages(known, corner_weights_of(energy)));
    REQUIRE(averages.size() == 2);
    CHECK(averages[1].weights == other);
    // What the subspace holds is reproduced, whatever counts more: energy or distance.
    for (double nearness : { 1e-6, 1.0, 1e12 }) {
        const TrainingSet training = training_of(reduced, averages, 2, nearness);
        CHECK(relative_distance(set, subspace.shape(training.averages[0]), mean) < 1e-9);
        CHECK(relative_distance(set, subspace.shape(training.averages[1]), set.shapes[1]) < 1e-9);
        CHECK(training.energy_scale > 0);
    }
}

TEST_CASE("training data lie between the reduced average and the projection of the true one")
{
    TubeFamily tube(2);
    auto& [set, energy, pool, family] = tube;
    const Shape& mean = family.mean().y;
    const Subspace subspace = build_subspace(set, Eigen::MatrixXd(set.dof_count(), 0), 1); // the difference alone
    const ReducedSolver reduced(energy, subspace, family.mean_hessian(), family.mean().energy);
    const auto averages = AverageProjector(energy, subspace, set, nullptr).project({ { equal_weights(2), &mean } });
    const auto shape_at
        = [&](double nearness) { return subspace.shape(training_of(reduced, averages, 1, nearness).averages[0]); };
    const Shape nearest = subspace.shape(project(subspace, mean, set.masses));
    CHECK(relative_distance(set, shape_at(1e12), nearest) < 1e-6);
    const double stiff = averages[0].stiffness(0, 0), free = relative_distance(set, shape_at(0), nearest);
    CHECK(relative_distance(set, shape_at(stiff), nearest) == doctest::Approx(free / 2).epsilon(1e-2));
}

TEST_CASE("an interpolated stiffness gives about the same training data")
{
    TubeFamily tube(3);
    auto& [set, energy, pool, family] = tube;
    InterpolatedFamily known(family, nullptr);
    const std::vector<Weights> weights = training_weights(3, 12, 1);
    const FoundSubspace found = build_adaptive_subspace(known, weights, { weights[11] }, AdaptiveOptions(), nullptr);
    const Subspace subspace = leading(found.subspace, 4);
    const AverageProjector projector(energy, subspace, set, nullptr);
    std::vector<AverageAt> others = distinct_averages(found.averages, corner_weights_of(energy));
    const AverageAt last = others.back();
    others.pop_back();
    const ProjectedAverage exact = projector.project({ last })[0],
                           near = projector.project({ last }, projector.project(others))[0];
    CHECK(near.energy == doctest::Approx(exact.energy));
    CHECK((near.nearest - exact.nearest).norm() < 1e-12 * exact.nearest.norm());
    CHECK((near.stiffness - exact.stiffness).norm() < 0.2 * exact.stiffness.norm());
    for (double nearness : { 0.0, exact.stiffness(3, 3) }) {
        // Without the forces outside of the subspace, training data would be the nearest points: the ratio would be 1.
        const Eigen::VectorXd wanted = reduced_average(exact, 4, nearness), found_one = reduced_average(near, 4, nearness);
        CHECK((found_one - wanted).norm() < 0.5 * (wanted - exact.nearest).norm());
    }
}

TEST_CASE("the smallest dimension that keeps the tolerance is found, with few measurements")
{
    SurrogateOptions options;
    options.tolerance = 1e-2;
    const auto error_of = [](double mean, double largest) { return BlendError { mean, largest, mean, largest }; };
    const auto found = [&](Eigen::Index most, const auto& mean_at, double largest, double rate) {
        int count = 0;
        const auto error_at = [&](Eigen::Index d) {
            CHECK(++count <= 11);
            return error_of(mean_at(d), largest);
        };
        return choose_dimension(
            3, most, options, [&](Eigen::Index d) { return std::exp(-rate * double(d)); }, error_at);
    };
    for (Eigen::Index needed : { 3, 4, 15, 40, 41 }) // at once, though the prediction knows nothing of it
        for (double rate : { 0.05, 0.3 }) {
            const auto jumps = [&](Eigen::Index d) { return d >= needed ? 1e-3 : 1e-1; };
            const Eigen::Index d = found(40, jumps, 2e-2, rate);
            CHECK(d >= (needed > 40 ? 3 : needed)); // out of reach: 3 dimensions are as good as 40
            CHECK(d <= (needed > 40 ? 3 : needed + needed / 16));
        }
    // Where the prediction says that the subspace is not the reason, the climb ends.
    CHECK(found(
              40, [](Eigen::Index) { return 1e-1; }, 2e-2, 2.0)
          == 3);
    // A good prediction leads to it directly.
    int count = 0;
    const auto falls = [&](Eigen::Index d) { return ++count, 3 * std::exp(-0.2 * double(d)); };
    const Eigen::Index chosen = found(64, falls, 0, 0.2);
    CHECK(falls(chosen) < 0.0075);
    CHECK(falls(chosen - 2) > 0.0075);
    CHECK(count <= 3 + 2);
    // A largest error that no dimension keeps does not cost dimensions.
    CHECK(found(
              40, [](Eigen::Index d) { return d < 9 ? 1.0 : 1e-3; }, 1.0, 0.2)
          == 9);
    // Parts count by what they drift, over their limit.
    CHECK(is_enough({ 1e-4, 1e-4, 1e-4, 1e-4, 0.7 }, options));
    CHECK(!is_enough({ 1e-4, 1e-4, 1e-4, 1e-4, 0.8 }, options));
    // An outlier decides nothing.
    CHECK(is_enough({ 1, 1, 1e-4, 1e-4 }, options));
}

TEST_CASE("all poses lead to one average, and a branch is known by its energy")
{
    const NormalizedPoses set = normalize(tube_poses(3));
    const DiscreteShells energy(set, ShellOptions());
    SolverPool pool(energy, set, default_solver());
    AverageFamily family(pool, NewtonOptions(), nullptr), same(pool, NewtonOptions(), nullptr, 2);
    CHECK(family.mean().has_converged);
    CHECK(family.branches().empty());
    CHECK(same.start_pose() == 2);
    CHECK(relative_distance(set, same.mean().y, family.mean().y) < 1e-5);
    Weights w(3);
    w << 0.7, 0.1, 0.2;
    const FamilyPoint point = family.at(w, 0, nullptr);
    CHECK(point.jumps.empty());
    const CheckPoint check = family.check(w, set.shapes[1], 0, 0, nullptr); // from a far pose: the same minimum
    CHECK(relative_distance(set, check.reference, point.average.y) < 1e-4);
    CHECK(check.branches.empty());
    CHECK(check.error > 0.01);
}

TEST_CASE("averages found from their neighbours are those followed from the mean, and are soon known between them")
{
    TubeFamily tube(3);
    auto& [set, energy, pool, family] = tube;
    family.mean();
    InterpolatedFamily known(family, nullptr);
    const std::vector<Weights> weights = training_weights(3, 30, 1);
    const int before = pool.factorization_count();
    const std::vector<Weights> wave(weights.begin() + 1, weights.begin() + 9);
    const std::vector<Shape> guesses = known.at(wave);
    const InterpolatedFamily::Wave learned = known.learn(wave, { "", 0, 8 });
    const std::vector<CheckPoint>& first = learned.averages;
    double excess = 0;
    for (std::size_t i = 0; i < wave.size(); ++i)
        excess += energy_value(energy, wave[i], guesses[i]) / energy_value(energy, wave[i], first[i].reference) - 1;
    CHECK(learned.energy_excess == doctest::Approx(excess / 8).epsilon(1e-3));
    const std::vector<CheckPoint> points = known.find({ weights.begin() + 9, weights.end() }, { "", 0, 21 });
    const int found = pool.factorization_count() - before;
    CHECK(known.learned_count() == 8);
    REQUIRE(points.size() == 21);
    double first_error = 0, error = 0;
    for (const CheckPoint& point : first) first_error += point.error / double(first.size());
    for (const CheckPoint& point : points) {
        CAPTURE(weights_text(point.weights));
        CHECK(point.has_converged);
        CHECK(point.branches.empty());
        CHECK(relative_distance(set, point.reference, family.at(point.weights, 0, nullptr).average.y) < 1e-4);
        CHECK(point.error == doctest::Approx(relative_distance(set, point.reference, known.at({ point.weights })[0])));
        error += point.error / double(points.size());
    }
    CHECK(error < 3e-4);
    CHECK(4 * error < first_error);
    CHECK(found < pool.factorization_count() - before - found); // of fewer averages
}

TEST_CASE("averages move with the weights as their derivatives say, whatever the energy")
{
    const NormalizedPoses set = normalize(tube_poses(3));
    for (const Material material : { Material::discrete_shells, Material::arap }) {
        CAPTURE(int(material));
        EnergyOptions options;
        options.material = material;
        const std::unique_ptr<Energy> energy = make_energy(set, options);
        SolverPool pool(*energy, set, default_solver());
        NewtonOptions newton;
        newton.decrement = 1e-12;
        AverageFamily family(pool, newton, nullptr);
        const Shape& mean = family.mean().y;
        NewtonSolver& solver = pool.at(0);
        const Eigen::MatrixXd directions = weight_directions(3);
        Eigen::MatrixXd derivatives = solver.weight_derivatives(equal_weights(3), mean, directions, false);
        keep_aligned(set, set.shapes[0], mean, derivatives);
        // The factor of a shape near by leads to the same.
        Weights beside = equal_weights(3) + 0.03 * directions.col(0);
        solver.factorize_equilibrium(beside, family.near(mean, beside, 0, nullptr).y);
        Eigen::MatrixXd rough = solver.rough_weight_derivatives(equal_weights(3), mean, directions),
                        refined = solver.weight_derivatives(equal_weights(3), mean, directions, true);
        keep_aligned(set, set.shapes[0], mean, rough);
        keep_aligned(set, set.shapes[0], mean, refined);
        CHECK((refined - derivatives).norm() < 1e-3 * derivatives.norm());
        CHECK((rough - derivatives).norm() > 3e-3 * derivatives.norm());
        constexpr double step = 1e-3;
        for (Eigen::Index c = 0; c < 2; ++c) {
            const Shape ahead = family.near(mean, equal_weights(3) + step * directions.col(c), 0, nullptr).y,
                        behind = family.near(mean, equal_weights(3) - step * directions.col(c), 0, nullptr).y;
            const Shape moved = (ahead - behind) / (2 * step);
            CHECK((moved - derivatives.col(c)).norm() < 1e-3 * moved.norm());
        }
    }
}

TEST_CASE("a bake that needs more memory than there is warns before it starts")
{
    struct Listener : Progress {
        void warn(int number, const std::string&, const std::string&) override { last = number; }
        int last = 0;
    } listener;
    warn_of_memory(1e9, 2e9, listener);
    CHECK(listener.last == 0);
    warn_of_memory(2e9, 1e9, listener);
    CHECK(listener.last == 4411);
    const double before = available_memory();
    CHECK(before > 1e8);
    rlimit limit {};
    getrlimit(RLIMIT_AS, &limit);
    const rlimit less { rlim_t(before / 2), limit.rlim_max };
    setrlimit(RLIMIT_AS, &less);
    CHECK(available_memory() <= before / 2);
    setrlimit(RLIMIT_AS, &limit);
}

TEST_CASE("a bake says what it measured, and the certificate holds it")
{
    Progress silent;
    BakeOptions options;
    options.check_count = 9;
    options.fresh_count = 3;
    const BakedAsset baked = bake(tube_poses(3), options, silent);
    const BakeReport& r = baked.report;
    CHECK(r.check.blends.size() == 12);
    CHECK(r.check.meets_tolerance);
    CHECK(r.check.mean_error < 1e-3);
    CHECK(r.fit.surrogate.curvature.lowest > 0);
    CHECK(r.check.cell_ratio > 0.1);
    CHECK(read_start_pose(r.certificate, 99, "") == r.start_pose);
    CHECK_THROWS_AS(read_start_pose(R"({"mean_from_pose": 1000000000000000000})", 2, "a.pliant"), Failure);
    CHECK(r.certificate.find("\"meets_tolerance\": true") != std::string::npos);
    options.tolerance_max = 1e-7; // below what single precision can do
    CHECK_FALSE(bake(tube_poses(3), options, silent).report.check.meets_tolerance);
}

TEST_CASE("a preview is cheap, the same each time, and certified; a limit that is not reached changes nothing")
{
    Progress silent;
    const PoseSet poses = tube_poses(4);
    BakeOptions options, preview;
    make_preview(preview, false);
    CHECK(preview.tolerance > options.tolerance);
    const BakedAsset quick = bake(poses, preview, silent), whole = bake(poses, options, silent);
    CHECK(bake(poses, preview, silent).bytes == quick.bytes);
    CHECK(quick.report.snapshot_count == 1); // the mean
    CHECK(quick.report.check.blends.size() == 8);
    CHECK(quick.report.check.mean_error < preview.tolerance);
    CHECK(quick.report.factorization_count < whole.report.factorization_count / 2);
    CHECK(quick.report.certificate.find("\"time_limit\": 0.0") != std::string::npos);
    CHECK(whole.report.certificate.find("time_limit") == std::string::npos);
    options.time_limit = 1e6;
    const BakeReport limited = bake(poses, options, silent).report;
    CHECK(limited.check.mean_error == whole.report.check.mean_error);
    CHECK(limited.check.blends.size() == whole.report.check.blends.size());
}

TEST_CASE("the average at a pose's own weights is the pose: forces there are rounding")
{
    TubeFamily tube(3);
    tube.family.mean();
    for (std::size_t k = 0; k < 3; ++k) {
        const NewtonResult average = tube.family.at(corner_weights(3, k), 0, nullptr).average;
        CHECK(average.has_converged);
        CHECK(average.energy < 1e-20);
        CHECK(relative_distance(tube.set, average.y, tube.set.shapes[k]) < 1e-8);
    }
}

TEST_CASE("the energy of a surface is shells, reinforced where it is rough, unless options state another")
{
    EnergyOptions options;
    CHECK(material_of(options, false) == Material::discrete_shells);
    CHECK(material_of(options, true) == Material::stvk);
    const NormalizedPoses set = normalize(tube_poses(3));
    CHECK(dynamic_cast<const ReinforcedShells*>(make_energy(set, options).get()));
    options.continuity = Continuity::off;
    CHECK(dynamic_cast<const DiscreteShells*>(make_energy(set, options).get()));
    options.material = Material::arap;
    CHECK(dynamic_cast<const Arap*>(make_energy(set, options).get()));
}

TEST_CASE("where averages of a shell jump, a miss points to ARAP")
{
    BakeReport report;
    report.check.blends.resize(1);
    report.check.worst_weights = equal_weights(2);
    report.check.meets_tolerance = false;
    const auto points_to_arap
        = [&] { return find_miss(report, {}, true)->hint.find("--material arap") != std::string::npos; };
    CHECK_FALSE(points_to_arap());
    report.branches.resize(1);
    CHECK(points_to_arap());
    report.input.material = Material::arap;
    CHECK_FALSE(points_to_arap());
    for (const bool has_layers : { false, true }) {
        CHECK(std::string(hint_for_jumps(Material::discrete_shells, has_layers)).find("arap") != std::string::npos);
        CHECK(std::string(hint_for_jumps(Material::arap, has_layers)).find("arap") == std::string::npos);
        CHECK(std::string(hint_for_jumps(Material::stvk, has_layers)).find("arap") == std::string::npos);
    }
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
    options.fresh_count = 1;
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
