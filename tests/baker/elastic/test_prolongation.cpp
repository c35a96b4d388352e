// The mean of a large surface: a coarse mesh of the same poses, where its vertices lie, shapes carried over, and the same
// average at a lower cost.
#include "../parts_mesh.h"
#include "bake/make_energy.h"
#include "base/mesh/align.h"
#include "base/mesh/tets.h"
#include "elastic/average/family.h"
#include "elastic/average/prolongation.h"
#include "elastic/average/shape_error.h"
#include "elastic/parts/tied_energy.h"

#include <doctest/doctest.h>

using namespace pliant;

namespace {

const Tube fine_tube { 150, 30 };

NormalizedPoses fine_set() { return normalize(tube_poses(4, fine_tube)); }

} // namespace

TEST_CASE("every pose of the coarse mesh has rows of the full one")
{
    const NormalizedPoses set = fine_set();
    const DecimatedPoses coarse = decimate(set, 1000);
    REQUIRE_FALSE(coarse.failed_face);
    CHECK(coarse.vertices.size() <= 1000);
    CHECK(coarse.vertices.size() > 900);
    for (std::size_t k = 0; k < set.pose_count(); ++k)
        for (std::size_t v = 0; v < coarse.vertices.size(); ++v)
            CHECK(point(coarse.set.shapes[k], std::uint32_t(v)) == point(set.shapes[k], coarse.vertices[v]));
    CHECK(coarse.set.masses.sum() == doctest::Approx(set.masses.sum()).epsilon(0.02));
}

TEST_CASE("a vertex of too many faces is told before it costs time")
{
    const std::uint32_t count = 4000;
    PoseSet poses;
    poses.names = { "fan" };
    poses.positions.emplace_back(Positions::Zero(count + 1, 3));
    for (std::uint32_t v = 0; v < count; ++v) {
        const double angle = 2 * 3.14159265358979323846 * v / count;
        poses.positions[0].row(v) << std::cos(angle), std::sin(angle), 0.1 * std::sin(9 * angle);
        poses.triangles.push_back({ count, v, (v + 1) % count });
    }
    CHECK(decimate(normalize(poses), 100).failed_face == std::size_t(1000));
}

TEST_CASE("flat parts keep sound triangles")
{
    // Each triangle of a rough surface is cut into 64, rounded as in a file.
    constexpr std::uint32_t cut = 8, side = 10 * cut + 1;
    const auto height = [](std::uint32_t i, std::uint32_t j) { return 4 * std::sin(3.0 * i) * std::cos(5.0 * j); };
    PoseSet poses = tube_poses(1);
    poses.positions[0].resize(side * side, 3);
    poses.triangles.clear();
    for (std::uint32_t v = 0; v < side * side; ++v) {
        const std::uint32_t x = v % side, y = v / side, i = x / cut, j = y / cut;
        const double a = double(x % cut) / cut, b = double(y % cut) / cut, near = height(i, j), far = height(i + 1, j + 1);
        const double z = a > b ? (1 - a) * near + (a - b) * height(i + 1, j) + b * far
                               : (1 - b) * near + (b - a) * height(i, j + 1) + a * far;
        poses.positions[0].row(v) << x, y, float(z);
        if (x == side - 1 || y == side - 1) continue;
        poses.triangles.push_back({ v, v + 1, v + side + 1 });
        poses.triangles.push_back({ v, v + side + 1, v + side });
    }
    const DecimatedPoses coarse = decimate(normalize(poses), side * side / 16);
    REQUIRE_FALSE(coarse.failed_face);
    const Eigen::VectorXd areas = cell_sizes(coarse.set, coarse.set.shapes[0]);
    CHECK(areas.size() < 2 * side * side / 4);
    CHECK(areas.minCoeff() > 1e-3 * areas.mean()); // 3e-20 without a limit of the aspect
}

TEST_CASE("vertices lie near their places, and parts that touch stay apart")
{
    PoseSet poses = tube_poses(1, fine_tube);
    const std::uint32_t count = std::uint32_t(poses.positions[0].rows());
    for (Triangle t : tube_poses(1, fine_tube).triangles) {
        for (std::uint32_t& v : t) v += count;
        poses.triangles.push_back(t);
    }
    Positions both(2 * count, 3); // the second tube lies in the first one
    both << poses.positions[0], 0.998 * poses.positions[0];
    poses.positions[0] = both;
    const NormalizedPoses set = normalize(poses);
    const DecimatedPoses coarse = decimate(set, 2000);
    const std::vector<CoarsePlace> places = find_coarse_places(set, coarse);
    REQUIRE(places.size() == 2 * count);
    double farthest = 0;
    for (std::uint32_t v = 0; v < places.size(); ++v) {
        const CoarsePlace& place = places[v];
        CHECK(place.weights.minCoeff() >= 0);
        CHECK(place.weights.sum() == doctest::Approx(1));
        Eigen::Vector3d at = Eigen::Vector3d::Zero();
        for (int c = 0; c < 3; ++c) {
            at += place.weights[c] * point(coarse.set.shapes[0], place.corners[std::size_t(c)]);
            CHECK((coarse.vertices[place.corners[std::size_t(c)]] < count) == (v < count));
        }
        farthest = std::max(farthest, (at - point(set.shapes[0], v)).norm());
    }
    CHECK(farthest < 0.005 * 6 / set.length); // the tube is 6 long, its radius 0.5
}

TEST_CASE("a pose of the coarse mesh becomes that pose of the full one")
{
    const NormalizedPoses set = fine_set();
    const DecimatedPoses coarse = decimate(set, 1000);
    Weights w = Weights::Constant(4, 0.25);
    for (std::size_t k = 0; k < set.pose_count(); ++k) {
        const Shape shape = prolong(set, coarse, 0, w, coarse.set.shapes[k], default_solver());
        CHECK(relative_distance(set, shape, set.shapes[k]) < 0.01);
    }
}

TEST_CASE("the mean by way of a coarse mesh is the mean, at a lower cost")
{
    const NormalizedPoses set = fine_set();
    const ElasticModel model = make_model(set, {});
    REQUIRE(model.coarse);
    CHECK_FALSE(model.coarse->coarser);
    SolverPool direct_pool(*model.energy, set, default_solver()), coarse_pool(*model.energy, set, default_solver());
    AverageFamily direct(direct_pool, {}, nullptr), by_coarse(coarse_pool, {}, nullptr, {}, model.coarse.get());
    const double distance = relative_distance(set, by_coarse.mean().y, direct.mean().y);
    MESSAGE("factorisations " << coarse_pool.factorization_count() << " instead of " << direct_pool.factorization_count()
                              << ", distance of the means " << distance);
    CHECK(distance < 1e-4);
    CHECK(2 * coarse_pool.factorization_count() < direct_pool.factorization_count());
    CHECK(by_coarse.start_pose() == direct.start_pose());
}

TEST_CASE("a character in parts has a coarse mesh with ties of its own")
{
    PartsMesh parts;
    parts.body = fine_tube;
    const NormalizedPoses set = normalize(parts.poses(4));
    const ElasticModel model = make_model(set, {});
    REQUIRE(model.coarse);
    CHECK(ties_of(*model.coarse->energy));
    SolverPool direct_pool(*model.energy, set, default_solver()), coarse_pool(*model.energy, set, default_solver());
    AverageFamily direct(direct_pool, {}, nullptr), by_coarse(coarse_pool, {}, nullptr, {}, model.coarse.get());
    CHECK(relative_distance(set, by_coarse.mean().y, direct.mean().y) < 1e-4);
    CHECK(coarse_pool.factorization_count() < direct_pool.factorization_count());
}

TEST_CASE("small meshes have no coarse one")
{
    const NormalizedPoses set = normalize(tube_poses(4));
    CHECK_FALSE(make_model(set, {}).coarse);
}
