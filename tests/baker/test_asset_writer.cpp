// The encoder's optional parts, looked at through the C runtime.
#include "train.h"
#include "tube.h"

#include "bake.h"
#include "pliant_format.h"
#include "reduce/training.h"
#include "subspace/krylov.h"
#include "write/asset_writer.h"
#include "write/runtime_blender.h"

#include <Eigen/Dense>
#include <cstring>
#include <doctest/doctest.h>
#include <numeric>

using namespace pliant;

namespace {

// A small tube whose stand-in has all elements at wrong weights, as if few had been chosen badly.
struct Problem {
    Problem()
        : poses(tube_poses(3, Tube { 10, 6 }))
        , set(normalise(poses))
        , energy(set, ShellOptions())
        , solver(energy, set, default_solver())
        , subspace(build_krylov_subspace(solver, { 1, 0, 256 }, nullptr))
        , reduced(energy, subspace)
        , training(train(solver, subspace, 12))
        , stand_in(energy, subspace.origin, subspace.basis, all_elements(), wrong_weights())
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

    AssetModel model() const
    {
        AssetModel out;
        out.set = &set;
        out.subspace = &subspace;
        out.stand_in = &stand_in;
        out.mean = training.averages[0];
        out.root = inverse_root(stand_in.hessian(training.weights[0], out.mean, HessianKind::exact), metric_floor);
        out.energy_scale = training.energy_scale;
        out.stand_in_reference = subspace.shape(out.mean);
        out.names = poses.names;
        out.certificate = "{}";
        out.answers.push_back({ training.weights[0], out.mean.cast<float>() });
        const Eigen::PartialPivLU<Eigen::MatrixXd> to_z(out.root);
        Eigen::MatrixXd starts(out.root.cols(), Eigen::Index(training.weights.size()));
        for (Eigen::Index i = 0; i < starts.cols(); ++i)
            starts.col(i) = to_z.solve(training.averages[std::size_t(i)] - out.mean);
        out.predictor = fit_predictor(training.weights, starts);
        return out;
    }

    // What holds the stand-in at the averages: minus its gradients by z there.
    Predictor load(const AssetModel& model) const
    {
        Eigen::MatrixXd forces(model.root.cols(), Eigen::Index(training.weights.size()));
        for (Eigen::Index i = 0; i < forces.cols(); ++i) {
            Eigen::VectorXd gradient;
            stand_in.gradient(training.weights[std::size_t(i)], training.averages[std::size_t(i)], gradient);
            forces.col(i) = -model.root.transpose() * gradient;
        }
        return fit_predictor(training.weights, forces);
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
    ShapeSet set;
    DiscreteShells energy;
    NewtonSolver solver;
    Subspace subspace;
    ReducedEnergy reduced;
    TrainingSet training;
    StandIn stand_in;
    std::size_t corner_count;
};

std::uint16_t minor_of(const std::vector<std::uint8_t>& bytes)
{
    pliant_format_header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    return header.format_minor;
}

} // namespace

TEST_CASE("a dead load puts the runtime's blends onto the averages it was fitted to")
{
    const Problem p;
    AssetModel model = p.model();
    const std::vector<std::uint8_t> bare = encode_asset(model);
    model.load = p.load(model);
    const std::vector<std::uint8_t> loaded = encode_asset(model);
    const double without = p.error(bare), with = p.error(loaded);
    CAPTURE(without);
    CAPTURE(with);
    CHECK(with < 1e-5);
    CHECK(without > 20 * 1e-5);
    CHECK(minor_of(bare) == 0);
    CHECK(minor_of(loaded) == PLIANT_FORMAT_MINOR_LOAD);
    model.load.reset();
    CHECK(encode_asset(model) == bare);
}

TEST_CASE("a dead load without the predictor's centres is refused")
{
    const Problem p;
    AssetModel model = p.model();
    model.load = p.load(model);
    model.load->centres[1] = p.training.weights[2];
    CHECK_THROWS_AS(encode_asset(model), std::invalid_argument);
    model.load = p.load(model);
    model.load->centres.pop_back();
    CHECK_THROWS_AS(encode_asset(model), std::invalid_argument);
    model.load = p.load(model);
    model.predictor = Predictor();
    CHECK_THROWS_AS(encode_asset(model), std::invalid_argument);
}

TEST_CASE("smoothing groups are written unless every vertex is its own")
{
    const Problem problem;
    AssetModel model = problem.model();
    const std::vector<std::uint8_t> plain = encode_asset(model);
    std::vector<std::uint32_t> groups(std::size_t(problem.set.dof_count() / 3));
    std::iota(groups.begin(), groups.end(), 0u);
    model.smoothing = &groups;
    CHECK(encode_asset(model) == plain);

    groups[5] = 2;
    const std::vector<std::uint8_t> bytes = encode_asset(model);
    CHECK(bytes[14] == PLIANT_FORMAT_MINOR_PARTS);
    pliant_asset asset;
    std::vector<std::uint8_t> aligned(bytes.size() + 64);
    std::uint8_t* start = aligned.data() + (64 - std::uintptr_t(aligned.data()) % 64) % 64;
    std::memcpy(start, bytes.data(), bytes.size());
    REQUIRE(pliant_asset_open(&asset, start, bytes.size(), PLIANT_OPEN_VERIFY_CHECKSUMS) == PLIANT_OK);
    REQUIRE(asset.smoothing_groups);
    CHECK(std::vector<std::uint32_t>(asset.smoothing_groups, asset.smoothing_groups + asset.vertex_count) == groups);

    groups[5] = asset.vertex_count;
    CHECK_THROWS_AS(encode_asset(model), std::invalid_argument);
    groups.pop_back();
    CHECK_THROWS_AS(encode_asset(model), std::invalid_argument);
}
