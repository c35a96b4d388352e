// Surfaces that ride on solids: barycentric coordinates, hostile files, and whole bakes that draw one.
#include "../twisted_bar.h"

#include "bake/bake.h"
#include "bake/certificate.h"
#include "input/poses/load_render_mesh.h"
#include "output/asset/asset_facts.h"
#include "output/asset/runtime_blender.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <unistd.h>

using namespace pliant;

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

Positions random_points(Eigen::Index count, const Eigen::RowVector3d& low, const Eigen::RowVector3d& high)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    Positions points(count, 3);
    for (Eigen::Index v = 0; v < count; ++v)
        for (Eigen::Index c = 0; c < 3; ++c) points(v, c) = low[c] + unit(random) * (high[c] - low[c]);
    return points;
}

Eigen::MatrixXd column(const Positions& positions) { return Eigen::Map<const Shape>(positions.data(), positions.size()); }

Positions turned(const Positions& positions, const Eigen::Matrix3d& map, const Eigen::RowVector3d& shift)
{
    return (positions * map.transpose()).rowwise() + shift;
}

// A file that is gone with the test.
struct TemporaryFile {
    TemporaryFile(const std::string& name, const std::string& text)
        : path((std::filesystem::temp_directory_path() / (std::to_string(getpid()) + name)).string())
    {
        std::ofstream(path) << text;
    }
    ~TemporaryFile() { std::filesystem::remove(path); }
    std::string path;
};

// A four-sided tube of quads along the bar, `half` off its axis, finer than the bar; open at both ends, with a seam of
// double vertices, a separate triangle, a face that is a line, and a vertex of no face.
std::string tube_text(double half, int rings)
{
    std::string text;
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < 5; ++s) {
            const double x = s == 1 || s == 2 ? -half : half, y = s == 2 || s == 3 ? -half : half;
            text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(6.0 * r / (rings - 1)) + "\n";
        }
    text += "v 0 0 3\nv 0.1 0 3\nv 0 0.1 3\nv 0.2 0.2 1\n";
    for (int r = 0; r + 1 < rings; ++r)
        for (int s = 1; s < 5; ++s) {
            const int a = 5 * r + s;
            text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + 6) + " "
                + std::to_string(a + 5) + "\n";
        }
    const std::string last = std::to_string(5 * rings + 1);
    return text + "f -4 -3 -2\nf -4 -3 -4\nf " + last + " -2 -3\n";
}

int number_of(const std::string& name, const std::string& text, const PoseSet& poses)
{
    const TemporaryFile file(name, text);
    try {
        load_render_mesh(file.path, poses);
    } catch (const Failure& failure) {
        return failure.diagnostics()[0].number;
    }
    return 0;
}

double relative(const std::vector<float>& found, const Eigen::VectorXd& wanted)
{
    const Eigen::VectorXd off
        = Eigen::Map<const Eigen::VectorXf>(found.data(), Eigen::Index(found.size())).cast<double>() - wanted;
    return off.norm() / wanted.norm();
}

} // namespace

TEST_CASE("barycentric coordinates reproduce affine maps, inside and outside")
{
    const PoseSet poses = twisted_bar(2, 10, 1);
    const Positions& rest = poses.positions[0];
    const Positions points = random_points(2000, { -0.8, -0.8, -0.3 }, { 0.8, 0.8, 6.3 });
    Eigen::Matrix3d map;
    map << 1, 0.2, -3, 0.5, 2, 0.1, -0.7, 0.3, 0.4;
    // Units and place must not matter.
    for (const double scale : { 1.0, 1e-9, 1e9 }) {
        CAPTURE(scale);
        const Eigen::RowVector3d far(0, 1000 * scale, 0);
        const Embedding embedding = embed(turned(points, scale * Eigen::Matrix3d::Identity(), far),
                                          turned(rest, scale * Eigen::Matrix3d::Identity(), far), poses.tets, unbounded);
        const Positions moved = turned(rest, map, { 4, 5, 6 }), wanted = turned(points, map, { 4, 5, 6 });
        CHECK((apply(embedding, column(moved)) - column(wanted)).lpNorm<Eigen::Infinity>() < 1e-10);
        CHECK((embedding.weights.colwise().sum().array() - 1).abs().maxCoeff() < 1e-14);
    }
}

TEST_CASE("points inside have coordinates in [0, 1], outside the distance from the solid")
{
    const PoseSet poses = twisted_bar(2, 10, 1);
    const Positions points = random_points(3000, { -0.8, -0.8, -0.3 }, { 0.8, 0.8, 6.3 });
    const Embedding embedding = embed(points, poses.positions[0], poses.tets, unbounded);
    const Embedding near = embed(points, poses.positions[0], poses.tets, 0.1);
    const Eigen::AlignedBox3d box(Eigen::Vector3d(-0.5, -0.5, 0), Eigen::Vector3d(0.5, 0.5, 6));
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const double distance = box.exteriorDistance(Eigen::Vector3d(points.row(v)));
        CHECK(embedding.distances[v] == doctest::Approx(distance).epsilon(1e-9));
        CHECK((near.distances[v] == unbounded) == (distance > 0.1));
        const auto weights = embedding.weights.col(v);
        if (distance == 0) CHECK((weights.minCoeff() >= 0 && weights.maxCoeff() <= 1));
        CHECK(weights.cwiseAbs().maxCoeff() < 4); // 0.3 outside cells of 0.5
    }
}

TEST_CASE("a vertex of the solid hangs on itself alone")
{
    const PoseSet poses = twisted_bar(2, 6, 1.3);
    const Embedding embedding = embed(poses.positions[0], poses.positions[0], poses.tets, 0.1);
    CHECK(apply(embedding, column(poses.positions[1])) == column(poses.positions[1]));
    CHECK(embedding.distances.isZero(0));
}

TEST_CASE("the nearest tetrahedron is the one that a search of all finds")
{
    // A twisted bar is not convex: boxes overlap, and so do the neighbourhoods of its sides.
    const PoseSet poses = twisted_bar(2, 6, 3);
    const Positions points = random_points(300, { -1, -1, -0.5 }, { 1, 1, 6.5 });
    const Embedding all = embed(points, poses.positions[1], poses.tets, unbounded);
    Eigen::VectorXd least = Eigen::VectorXd::Constant(points.rows(), unbounded);
    for (const Tetrahedron& tet : poses.tets)
        least = least.cwiseMin(embed(points, poses.positions[1], { tet }, unbounded).distances);
    CHECK((all.distances - least).lpNorm<Eigen::Infinity>() < 1e-12);
}

TEST_CASE("an asset that draws a surface blends as the embedded solid does")
{
    const PoseSet poses = twisted_bar(2, 10, 2);
    const TemporaryFile file("tube.obj", tube_text(0.47, 40));
    for (const Material material : { Material::stvk, Material::mooney_rivlin }) {
        BakeOptions options;
        options.energy.material = material;
        options.position_error = 0; // each would be packed by itself
        Progress silent;
        const BakedAsset plain = bake(poses, options, silent);
        options.render_mesh = std::make_shared<const RenderMesh>(load_render_mesh(file.path, poses));
        const BakedAsset drawn = bake(poses, options, silent);
        RuntimeBlender solid(plain.bytes, "plain"), surface(drawn.bytes, "drawn", true);
        CHECK(surface.asset().vertex_count == 204);
        CHECK(surface.asset().boundary_vertex_count == 204);
        CHECK(surface.source_vertices().empty());
        CHECK(surface.faces().count() == 159); // 156 quads, 3 triangles
        CHECK(surface.asset().triangle_count == 315);
        for (const float w : { 0.f, 0.2f, 0.5f, 0.85f, 1.f }) {
            const std::vector<float> q = solid.solve({ 1 - w, w }, false);
            CHECK(surface.solve({ 1 - w, w }, false) == q); // the same bits: what is drawn has no part in solving
            const std::vector<float> vertices = solid.positions(q);
            const Eigen::VectorXd blend
                = Eigen::Map<const Eigen::VectorXf>(vertices.data(), Eigen::Index(vertices.size())).cast<double>();
            CHECK(relative(surface.positions(q), apply(options.render_mesh->embedding, blend)) < 1e-6);
        }
        REQUIRE(drawn.report.check.render_mesh);
        CHECK(drawn.report.check.render_mesh->mean > 0);
        CHECK(drawn.report.check.render_mesh->mean <= drawn.report.check.render_mesh->largest);
        CHECK(drawn.report.check.render_mesh->mean < 2 * drawn.report.check.mean_error);
        CHECK(drawn.report.check.mean_error == plain.report.check.mean_error);
        CHECK(has_render_mesh(surface.certificate()));
        CHECK(!has_render_mesh(solid.certificate()));
    }
}

TEST_CASE("what a surface may not be")
{
    const PoseSet solid = twisted_bar(2, 6, 1);
    PoseSet surface = solid;
    surface.tets.clear();
    CHECK(number_of("good.obj", tube_text(0.5, 7), solid) == 0);
    CHECK(number_of("good.obj", tube_text(0.5, 7), surface) == 1209);
    CHECK(number_of("index.obj", "v 0 0 1\nv 0 0.1 1\nv 0.1 0 1\nf 1 2 4\n", solid) == 2103);
    CHECK(number_of("nan.obj", "v 0 0 1\nv 0 nan 1\nv 0.1 0 1\nf 1 2 3\n", solid) == 2105);
    CHECK(number_of("line.obj", "v 0 0 1\nv 0 0.1 1\nv 0 0.2 1\nf 1 2 3\nf 1 1 2\n", solid) == 2608);
    CHECK(number_of("point.obj", "v 0 0 1\nv 0 0 1\nv 0 0 1\nf 1 2 3\n", solid) == 2608);
    CHECK(number_of("far.obj", "v 0 0 1\nv 0.1 0 1\nv 0 0.9 1\nf 1 2 3\n", solid) == 2606);
    CHECK(number_of("huge.obj", "v 0 0 1\nv 0 1e17 1\nv 1e17 0 1\nf 1 2 3\n", solid) == 2606);
}

TEST_CASE("vertices a little outside are warned of, and counted")
{
    const PoseSet poses = twisted_bar(2, 6, 1); // the diagonal is 6.16
    const auto load = [&](double half, std::vector<Diagnostic>& warnings) {
        const TemporaryFile file("tube.obj", tube_text(half, 7));
        return load_render_mesh(file.path, poses, &warnings);
    };
    std::vector<Diagnostic> warnings;
    CHECK(load(0.45, warnings).outside_count == 0);
    const RenderMesh near = load(0.51, warnings);
    CHECK(near.outside_count == 35);
    CHECK(near.largest_weight > 1);
    CHECK(warnings.empty());
    const RenderMesh farther = load(0.6, warnings);
    CHECK(farther.farthest_outside == doctest::Approx(std::sqrt(0.02) / std::sqrt(38.0)));
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].number == 2607);
    CHECK(warnings[0].what.find("35 vertices") != std::string::npos);
}
