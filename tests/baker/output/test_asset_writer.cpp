// The encoder's optional parts, looked at through the C runtime.
#include "../train.h"
#include "../tube.h"

#include "bake/bake.h"
#include "output/asset/asset_writer.h"
#include "output/asset/runtime_blender.h"
#include "pliant_format.h"
#include "reduced/subspace/krylov.h"
#include "reduced/surrogate/training.h"

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>
#include <numeric>

using namespace pliant;

namespace {

// A small tube whose surrogate energy has all elements at wrong weights, as if few had been chosen badly.
struct Problem {
    explicit Problem(const Tube& tube = { 10, 6 })
        : poses(tube_poses(3, tube))
        , set(normalize(poses))
        , energy(set, ShellOptions())
        , solver(energy, set, default_solver())
        , subspace(build_krylov_subspace(solver, { 1, 0, 256 }, nullptr))
        , reduced(energy, subspace)
        , training(train(solver, subspace, 12))
        , surrogate(std::make_shared<const SurrogateEnergy>(energy, subspace.rest, subspace.basis, all_elements(),
                                                            wrong_weights()))
        , corner_count(set.pose_count())
    {
        // Poses are averages as well: known at the corners.
        for (std::size_t k = 0; k < corner_count; ++k) {
            training.weights.push_back(corner_weights(corner_count, k));
            training.averages.push_back(subspace.pose_coordinates.col(Eigen::Index(k)));
        }
    }

    std::vector<std::size_t> all_elements() const
    {
        std::vector<std::size_t> ids(energy.element_count());
        std::iota(ids.begin(), ids.end(), 0);
        return ids;
    }
    Eigen::VectorXd wrong_weights() const
    {
        Eigen::VectorXd weights(Eigen::Index(energy.element_count()));
        for (Eigen::Index i = 0; i < weights.size(); ++i) weights[i] = 1 + 0.4 * std::sin(2.0 * double(i));
        return weights;
    }

    BlendModel model() const
    {
        BlendModel out;
        out.surrogate = surrogate;
        out.mean = training.averages[0];
        out.whitening = whitening_of(surrogate->hessian(training.weights[0], out.mean, HessianKind::exact), metric_floor);
        out.energy_scale = training.energy_scale;
        const Eigen::PartialPivLU<Eigen::MatrixXd> to_z(out.whitening);
        Eigen::MatrixXd starts(out.whitening.cols(), Eigen::Index(training.weights.size()));
        for (Eigen::Index i = 0; i < starts.cols(); ++i)
            starts.col(i) = to_z.solve(training.averages[std::size_t(i)] - out.mean);
        out.predictor = fit_radial_function(training.weights, starts);
        return out;
    }

    // With the basis within `error` (normalized units; 0: single precision) at the averages.
    AssetModel asset(const BlendModel& model, double error = 0) const
    {
        AssetModel out { set, subspace, model,       subspace.shape(model.mean),
                         {},  {},       poses.names, WeightDomain::simplex(set.pose_count()) };
        out.mesh.triangles = set.triangles;
        out.mesh.vertex_count = std::size_t(set.dof_count() / 3);
        out.shape = store_shape(set, subspace, nullptr, reachable(), error, std::size_t(set.dof_count() / 3));
        return out;
    }

    // As above, but the vertices are drawn again and again until there are so many.
    AssetModel copies(const BlendModel& model, double error, std::size_t drawn_count) const
    {
        AssetModel out = asset(model);
        std::vector<std::uint32_t> places;
        for (std::size_t i = 0; i < drawn_count; ++i) places.push_back(std::uint32_t(i % out.mesh.vertex_count));
        const std::shared_ptr<const RenderMesh> drawn = copy_to_render_mesh({}, {}, places);
        out.mesh.vertex_count = places.size();
        out.shape = store_shape(set, subspace, &drawn->embedding, reachable(), error, places.size());
        return out;
    }

    std::vector<std::uint8_t> encode(const AssetModel& asset) const
    {
        AssetRecord record;
        record.answers = { { training.weights[0], asset.shape.frame.stored(asset.model.mean).cast<float>() } };
        return encode_asset(asset, record);
    }

    Eigen::MatrixXd reachable() const
    {
        Eigen::MatrixXd out(subspace.dimension(), Eigen::Index(training.averages.size()));
        for (std::size_t i = 0; i < training.averages.size(); ++i) out.col(Eigen::Index(i)) = training.averages[i];
        return out; // the last ones are the poses
    }

    // What holds the surrogate energy at the averages: minus its gradients by z there.
    RadialFunction load(const BlendModel& model) const
    {
        Eigen::MatrixXd forces(model.whitening.cols(), Eigen::Index(training.weights.size()));
        for (Eigen::Index i = 0; i < forces.cols(); ++i) {
            Eigen::VectorXd gradient;
            surrogate->gradient(training.weights[std::size_t(i)], training.averages[std::size_t(i)], gradient);
            forces.col(i) = -model.whitening.transpose() * gradient;
        }
        return fit_radial_function(training.weights, forces);
    }

    // Largest distance of the runtime's answers from the averages, relative to the largest difference between poses.
    double error(const std::vector<std::uint8_t>& bytes) const
    {
        RuntimeBlender blender(bytes, "memory", true);
        pliant_solver_desc desc = pliant_solver_desc_default();
        desc.tolerance = 1e-5f;
        blender.configure(desc);
        double largest = 0;
        for (std::size_t i = 0; i < training.weights.size(); ++i) {
            const Eigen::VectorXf w = training.weights[i].cast<float>();
            const std::vector<float> q = blender.solve({ w.data(), w.data() + w.size() }, false);
            const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size())).cast<double>();
            largest = std::max(largest, (found - training.averages[i]).norm());
        }
        return largest / subspace.pose_coordinates.colwise().norm().maxCoeff();
    }

    PoseSet poses;
    NormalizedPoses set;
    DiscreteShells energy;
    NewtonSolver solver;
    Subspace subspace;
    ReducedEnergy reduced;
    TrainingSet training;
    std::shared_ptr<const SurrogateEnergy> surrogate;
    std::size_t corner_count;
};

} // namespace

TEST_CASE("a dead load puts the runtime's blends onto the averages it was fitted to")
{
    const Problem p;
    BlendModel model = p.model();
    const std::vector<std::uint8_t> bare = p.encode(p.asset(model));
    model.load = p.load(model);
    const std::vector<std::uint8_t> loaded = p.encode(p.asset(model));
    const double without = p.error(bare), with = p.error(loaded);
    CAPTURE(without);
    CAPTURE(with);
    CHECK(with < 1e-5);
    CHECK(without > 20 * 1e-5);
    model.load.reset();
    CHECK(p.encode(p.asset(model)) == bare);
}

TEST_CASE("a dead load without the predictor's centres is refused")
{
    const Problem p;
    BlendModel model = p.model();
    model.load = p.load(model);
    model.load->centres[1] = p.training.weights[2];
    CHECK_THROWS_AS(p.encode(p.asset(model)), std::invalid_argument);
    model.load = p.load(model);
    model.load->centres.pop_back();
    CHECK_THROWS_AS(p.encode(p.asset(model)), std::invalid_argument);
    model.load = p.load(model);
    model.predictor = RadialFunction();
    CHECK_THROWS_AS(p.encode(p.asset(model)), std::invalid_argument);
}

TEST_CASE("smoothing groups are written unless every vertex is its own")
{
    const Problem p;
    const BlendModel model = p.model();
    AssetModel drawn = p.asset(model);
    const std::vector<std::uint8_t> plain = p.encode(drawn);
    std::vector<std::uint32_t>& groups = drawn.mesh.smoothing;
    groups.resize(drawn.mesh.vertex_count);
    std::iota(groups.begin(), groups.end(), 0u);
    CHECK(p.encode(drawn) == plain);

    groups[5] = 2;
    const std::vector<std::uint8_t> bytes = p.encode(drawn);
    CHECK(bytes[14] == PLIANT_FORMAT_MINOR_PARTS);
    pliant_asset asset;
    std::vector<std::uint8_t> aligned(bytes.size() + 64);
    std::uint8_t* start = aligned.data() + (64 - std::uintptr_t(aligned.data()) % 64) % 64;
    std::memcpy(start, bytes.data(), bytes.size());
    REQUIRE(pliant_asset_open(&asset, start, bytes.size(), PLIANT_OPEN_VERIFY_CHECKSUMS) == PLIANT_OK);
    REQUIRE(asset.smoothing_groups);
    CHECK(std::vector<std::uint32_t>(asset.smoothing_groups, asset.smoothing_groups + asset.vertex_count) == groups);

    groups[5] = asset.vertex_count;
    CHECK_THROWS_AS(p.encode(drawn), std::invalid_argument);
    groups.pop_back();
    CHECK_THROWS_AS(p.encode(drawn), std::invalid_argument);
}

namespace {

// The farthest vertex of the runtime's shape from the subspace's, normalized units; checks the box round it, too.
double farthest_vertex(const Problem& p, const StoredShape& stored, const RuntimeBlender& blender, const Eigen::VectorXd& q)
{
    const Eigen::VectorXf to_runtime = stored.frame.stored(q).cast<float>();
    const std::vector<float> coordinates(to_runtime.data(), to_runtime.data() + to_runtime.size());
    const std::vector<float> positions = blender.positions(coordinates);
    const Shape off = from_input_units(p.set, positions) - p.subspace.shape(q);
    float low[3], high[3];
    REQUIRE(pliant_bounds(&blender.asset(), coordinates.data(), low, high) == PLIANT_OK);
    double farthest = 0;
    for (Eigen::Index i = 0; i < off.size(); i += 3) {
        farthest = std::max(farthest, off.segment<3>(i).norm());
        for (Eigen::Index c = 0; c < 3; ++c) {
            REQUIRE(positions[std::size_t(i + c)] >= low[c]);
            REQUIRE(positions[std::size_t(i + c)] <= high[c]);
        }
    }
    return farthest;
}

} // namespace

TEST_CASE("a factored basis keeps its position error at averages, poses and between them")
{
    const Problem p;
    const BlendModel model = p.model();
    const std::vector<std::uint8_t> plain = p.encode(p.asset(model));
    const Eigen::MatrixXd reachable = p.reachable();
    for (double error : { 1e-2, 1e-3, 1e-4 }) {
        CAPTURE(error);
        const AssetModel asset = p.asset(model, error * p.set.diagonal);
        const StoredShape& stored = asset.shape;
        REQUIRE_FALSE(stored.basis.empty());
        CHECK(stored.largest_error <= error * p.set.diagonal);
        CHECK(stored.largest_error > 0.5 * error * p.set.diagonal); // no more bits than it takes
        const std::vector<std::uint8_t> bytes = p.encode(asset);
        CHECK(bytes.size() < plain.size());
        RuntimeBlender blender(bytes, "memory", true), exact(plain, "memory", true);
        const double allowed = (error + 1e-6) * p.set.diagonal; // single precision besides
        for (Eigen::Index i = 0; i < reachable.cols(); ++i) {
            CHECK(farthest_vertex(p, stored, blender, reachable.col(i)) < allowed);
            CHECK(farthest_vertex(p, stored, blender, (reachable.col(i) + reachable.col(0)) / 2) < allowed);
        }
        CHECK(farthest_vertex(p, stored, blender, reachable.col(0) + 50 * Eigen::VectorXd::Random(reachable.rows())) > 0);
        // The same blends in other coordinates.
        const Eigen::VectorXf w = p.training.weights[2].cast<float>();
        const std::vector<float> q = blender.solve({ w.data(), w.data() + w.size() }, false),
                                 same = exact.solve({ w.data(), w.data() + w.size() }, false);
        const Eigen::VectorXd back
            = stored.frame.coordinates(Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size())).cast<double>());
        const Eigen::VectorXd wanted
            = Eigen::Map<const Eigen::VectorXf>(same.data(), Eigen::Index(same.size())).cast<double>();
        CHECK((back - wanted).norm() < 1e-5 * p.subspace.pose_coordinates.norm());
    }
}

TEST_CASE("vertices at one place stay at one place, in whatever blocks and however many they are")
{
    const Problem p(Tube { 10, 7 });
    const BlendModel model = p.model();
    const auto n = std::size_t(p.set.dof_count() / 3);
    // Four vertices of a second block; more at each place than a tile holds, which makes larger blocks worth it.
    for (const auto& [drawn_count, block_vertices] : { std::pair(4100U, 4096U), std::pair(6000U, 65536U) }) {
        CAPTURE(drawn_count);
        const AssetModel asset = p.copies(model, 1e-3 * p.set.diagonal, drawn_count);
        pliant_format_factored head {};
        REQUIRE(asset.shape.basis.size() > sizeof head);
        std::memcpy(&head, asset.shape.basis.data(), sizeof head);
        CHECK(head.block_vertices == block_vertices);
        const RuntimeBlender blender(p.encode(asset), "memory", true);
        for (Eigen::Index s = 0; s < p.reachable().cols(); ++s) {
            const Eigen::VectorXf q = asset.shape.frame.stored(p.reachable().col(s)).cast<float>();
            const std::vector<float> drawn = blender.positions({ q.data(), q.data() + q.size() });
            std::size_t apart_count = 0;
            for (std::size_t i = 3 * n; i < drawn.size(); ++i) apart_count += drawn[i] != drawn[i % (3 * n)];
            CHECK(apart_count == 0);
        }
    }
}

TEST_CASE("an error that 16 bits of a row cannot keep leaves the basis in single precision")
{
    const Problem p;
    const BlendModel model = p.model();
    CHECK(p.asset(model, 1e-5 * p.set.diagonal).shape.basis.empty());
}

TEST_CASE("columns come in the order of what they move, and few are needed near the middle")
{
    const Problem p;
    const BlendModel model = p.model();
    const Eigen::MatrixXd reachable = p.reachable();
    const AssetModel asset = p.asset(model, 1e-4 * p.set.diagonal);
    const StoredShape& stored = asset.shape;
    const RuntimeBlender blender(p.encode(asset), "memory");
    float last = INFINITY;
    for (std::uint32_t j = 0; j < blender.asset().dimension; ++j) {
        pliant_column column;
        REQUIRE(pliant_asset_column(&blender.asset(), j, &column) == PLIANT_OK);
        CHECK(column.reach * column.limit <= 1.01F * last + 1e-6F);
        last = column.reach * column.limit;
        double largest = 0;
        for (Eigen::Index i = 0; i < reachable.cols(); ++i)
            largest = std::max(largest, std::abs(stored.frame.stored(reachable.col(i))[Eigen::Index(j)]));
        CHECK(column.limit == doctest::Approx(reach_margin * largest).epsilon(1e-5));
    }
}

TEST_CASE("what single precision does as well stays in single precision")
{
    const Problem p;
    const Eigen::MatrixXd reachable = p.reachable();
    const BlendModel model = p.model();
    for (double error : { 0.0, 1e-12 }) {
        const AssetModel asset = p.asset(model, error);
        const StoredShape& stored = asset.shape;
        CHECK(stored.basis.empty());
        CHECK(stored.frame.axes.isIdentity(0));
        const RuntimeBlender blender(p.encode(asset), "memory", true);
        CHECK(blender.asset().basis != nullptr);
        for (Eigen::Index i = 0; i < reachable.cols(); ++i)
            CHECK(farthest_vertex(p, stored, blender, reachable.col(i)) < 1e-6 * p.set.diagonal);
    }
}
