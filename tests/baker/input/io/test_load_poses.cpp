// From files to a set of poses, and that verdicts depend neither on units nor on the place.
#include <doctest/doctest.h>

#include "files.h"
#include "input/poses/check_surface.h"
#include "input/poses/load_poses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace pliant;
using pliant_test::TemporaryFolder;

namespace {

// Poses as text in double precision, so that nothing is rounded on the way.
void write_off(const std::string& path, const Positions& positions, const std::vector<Triangle>& triangles)
{
    std::string text = "OFF\n" + std::to_string(positions.rows()) + " " + std::to_string(triangles.size()) + " 0\n";
    char line[128];
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
        std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", positions(v, 0), positions(v, 1), positions(v, 2));
        text += line;
    }
    for (const Triangle& t : triangles) {
        std::snprintf(line, sizeof line, "3 %u %u %u\n", t[0], t[1], t[2]);
        text += line;
    }
    pliant_test::write_bytes(path, text);
}

// A closed, lopsided surface: a sphere of rings with bumps. About 2 ring_count^2 vertices.
struct Model {
    Positions positions;
    std::vector<Triangle> triangles;
};

Model make_blob(std::uint32_t rings)
{
    Model model;
    const std::uint32_t segments = 2 * rings;
    model.positions.resize(rings * segments + 2, 3);
    const auto place = [&](Eigen::Index vertex, double theta, double phi) {
        const double radius = 1 + 0.2 * std::sin(3 * theta + phi) + 0.1 * std::cos(2 * phi);
        model.positions.row(vertex) << 1.3 * radius * std::sin(theta) * std::cos(phi),
            radius * std::sin(theta) * std::sin(phi), 2 * radius * std::cos(theta);
    };
    for (std::uint32_t r = 0; r < rings; ++r) {
        for (std::uint32_t s = 0; s < segments; ++s)
            place(r * segments + s, 3.14159265 * (r + 1) / (rings + 1), 6.2831853 * s / segments);
    }
    const std::uint32_t north = rings * segments, south = north + 1;
    place(north, 0, 0);
    place(south, 3.14159265, 0);
    for (std::uint32_t s = 0; s < segments; ++s) {
        const std::uint32_t next = (s + 1) % segments;
        model.triangles.push_back({ north, s, next });
        model.triangles.push_back({ south, (rings - 1) * segments + next, (rings - 1) * segments + s });
        for (std::uint32_t r = 0; r + 1 < rings; ++r) {
            const std::uint32_t a = r * segments + s, b = r * segments + next, c = a + segments, d = b + segments;
            model.triangles.push_back({ a, c, d });
            model.triangles.push_back({ a, d, b });
        }
    }
    return model;
}

Positions bent(const Positions& positions, double amount)
{
    Positions result = positions;
    for (Eigen::Index v = 0; v < result.rows(); ++v) result(v, 0) += amount * result(v, 2) * result(v, 2);
    return result;
}

// All numbers found, errors and warnings, in order.
std::vector<int> numbers_of(const std::vector<Positions>& poses, const std::vector<Triangle>& triangles)
{
    const TemporaryFolder folder;
    std::vector<std::string> paths;
    for (const Positions& pose : poses) {
        paths.push_back(folder / ("pose" + std::to_string(paths.size()) + ".off"));
        write_off(paths.back(), pose, triangles);
    }
    std::vector<Diagnostic> diagnostics;
    try {
        load_poses(paths, {}, &diagnostics);
    } catch (const Failure& failure) {
        CHECK(failure.code() == ExitCode::bad_input);
        diagnostics = failure.diagnostics();
    }
    std::vector<int> numbers;
    for (const Diagnostic& diagnostic : diagnostics) numbers.push_back(diagnostic.number);
    return numbers;
}

using Numbers = std::vector<int>;

} // namespace

TEST_CASE("a fan from the first corner")
{
    Polygons polygons;
    polygons.indices = { 4, 5, 6, 7, 8, 2, 1, 0 };
    polygons.offsets = { 0, 5, 8 };
    const Triangulation t = triangulate(polygons);
    CHECK(t.triangles == std::vector<Triangle> { { 4, 5, 6 }, { 4, 6, 7 }, { 4, 7, 8 }, { 2, 1, 0 } });
    CHECK(t.faces == std::vector<std::uint32_t> { 0, 0, 0, 1 });
}

TEST_CASE("faces may start at another corner; those of the first pose are used for all")
{
    const TemporaryFolder folder;
    pliant_test::write_bytes(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 3 4\nf 2 5 3\n");
    pliant_test::write_bytes(folder / "b.obj", "v 0 0 1\nv 1 0 0\nv 1 1 0\nv 0 1 1\nv 2 0 1\nf 3 4 1 2\nf 3 2 5\n");
    const PoseSet poses = load_poses({ folder / "a.obj", folder / "b.obj" });
    CHECK(poses.polygons.indices == std::vector<std::uint32_t> { 0, 1, 2, 3, 1, 4, 2 });
    CHECK(poses.triangles == std::vector<Triangle> { { 0, 1, 2 }, { 0, 2, 3 }, { 1, 4, 2 } });
    CHECK(poses.names == std::vector<std::string> { "a", "b" });
    CHECK(poses.positions[1](4, 2) == 1);
    // The other way round is another face.
    pliant_test::write_bytes(folder / "c.obj", "v 0 0 1\nv 1 0 0\nv 1 1 0\nv 0 1 1\nv 2 0 1\nf 4 3 2 1\nf 3 2 5\n");
    CHECK(pliant_test::number_of([&] { load_poses({ folder / "a.obj", folder / "c.obj" }); }) == 3004);
}

TEST_CASE("all files are looked at before anything is thrown")
{
    const TemporaryFolder folder;
    pliant_test::write_bytes(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 x\nf 1 2 9\n");
    pliant_test::write_bytes(folder / "b.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 0\n");
    try {
        load_poses({ folder / "a.obj", folder / "b.obj", folder / "c.obj" });
        FAIL("was accepted");
    } catch (const Failure& failure) {
        Numbers numbers;
        for (const Diagnostic& diagnostic : failure.diagnostics()) numbers.push_back(diagnostic.number);
        CHECK(numbers == Numbers { 2106, 2103, 2105, 2107, 2001 });
    }
}

TEST_CASE("no verdict depends on the unit of length or on the place")
{
    const Model blob = make_blob(8);
    const Positions& rest = blob.positions;
    const Positions pose = bent(rest, 0.3);
    const Triangle t = blob.triangles[40];

    std::vector<std::pair<const char*, std::vector<Positions>>> cases;
    cases.push_back({ "good", { rest, pose } });
    Positions flat = pose; // one corner on the opposite edge
    flat.row(t[2]) = 0.3 * flat.row(t[0]) + 0.7 * flat.row(t[1]);
    cases.push_back({ "zero area", { rest, flat } });
    Positions point = pose; // all corners in one point
    point.row(t[2]) = point.row(t[1]) = point.row(t[0]);
    cases.push_back({ "one point", { rest, point } });
    Positions sliver = pose; // a height of 1e-4 edges: thin but a triangle
    sliver.row(t[2]) = 0.5 * (sliver.row(t[0]) + sliver.row(t[1])) + 1e-4 * (pose.row(t[2]) - pose.row(t[0]));
    cases.push_back({ "sliver", { rest, sliver } });
    cases.push_back({ "identical", { rest, rest } });
    cases.push_back({ "mirrored", { rest, pose * Eigen::Vector3d(-1, 1, 1).asDiagonal() } });
    cases.push_back({ "other unit", { rest, 100 * pose } });
    Positions shuffled = pose;
    std::vector<Eigen::Index> order(static_cast<std::size_t>(rest.rows()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(3));
    for (Eigen::Index v = 0; v < rest.rows(); ++v) shuffled.row(v) = pose.row(order[static_cast<std::size_t>(v)]);
    cases.push_back({ "shuffled", { rest, shuffled } });
    const std::vector<Numbers> expected = { {}, { 2202 }, { 2202 }, {}, { 3009 }, { 3007 }, { 3008 }, { 3006 } };

    for (std::size_t i = 0; i < cases.size(); ++i) {
        CAPTURE(cases[i].first);
        const auto found = [&](double scale, double offset) {
            std::vector<Positions> moved = cases[i].second;
            for (Positions& p : moved) p = (scale * p.array() + offset).matrix();
            Numbers numbers = numbers_of(moved, blob.triangles);
            if (offset != 0) // blends are rounded there
                numbers.erase(std::remove(numbers.begin(), numbers.end(), 2209), numbers.end());
            numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end()); // several triangles share the spot
            return numbers;
        };
        CHECK(found(1, 0) == expected[i]);
        for (const double scale : { 1e-6, 1e6, 3.7 }) {
            CAPTURE(scale);
            CHECK(found(scale, 0) == expected[i]);
        }
        CHECK(found(1, 1e6) == expected[i]);
        CHECK(found(1e-6, 1) == expected[i]);
    }
}

TEST_CASE("a vertex without faces, far away, turns no open surface inside out")
{
    Model blob = make_blob(8);
    const double brim = 0.8 * blob.positions.col(0).maxCoeff();
    const auto is_beyond = [&](const Triangle& t) { return blob.positions(t[0], 0) > brim; };
    blob.triangles.erase(std::remove_if(blob.triangles.begin(), blob.triangles.end(), is_beyond), blob.triangles.end());
    Positions rest(blob.positions.rows() + 1, 3), pose = rest;
    rest << blob.positions, 1e4, 0, 0;
    pose << bent(blob.positions, 0.3) * Eigen::Vector3d(-1, -1, 1).asDiagonal(), 1e4, 0, 0;
    for (const int number : numbers_of({ rest, pose }, blob.triangles)) CHECK(number / 100 == 22); // warnings
}

TEST_CASE("a mirror image is told from parts of which one is inside out")
{
    const Model blob = make_blob(6);
    const std::uint32_t count = std::uint32_t(blob.positions.rows());
    std::vector<Triangle> triangles = blob.triangles;
    for (const Triangle& t : blob.triangles) triangles.push_back({ t[0] + count, t[1] + count, t[2] + count });
    const auto pair_of = [&](double left, double right) { // the right one is the mirror image of the left one
        Positions both(2 * count, 3);
        both << left * blob.positions, right * blob.positions * Eigen::Vector3d(-1, 1, 1).asDiagonal();
        both.col(0).tail(count).array() += 8;
        return both;
    };
    const Positions rest = pair_of(1, 0.8), pose = pair_of(0.8, 1);
    for (const bool is_mirrored : { false, true }) {
        const Positions other = pose * Eigen::Vector3d(1, is_mirrored ? -1 : 1, 1).asDiagonal();
        const Numbers numbers = numbers_of({ rest, other }, triangles);
        CHECK(std::count(numbers.begin(), numbers.end(), 3007) == (is_mirrored ? 1 : 0));
    }
}

TEST_CASE("moved and turned poses are fine, and the same when they are aligned")
{
    const Model blob = make_blob(6);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Positions turned = (bent(blob.positions, 0.3) * turn).rowwise() + Eigen::RowVector3d(10, 20, 30);
    CHECK(numbers_of({ blob.positions, turned }, blob.triangles).empty());
    const Positions moved = (blob.positions * turn).rowwise() + Eigen::RowVector3d(10, 20, 30);
    CHECK(numbers_of({ blob.positions, moved }, blob.triangles) == Numbers { 3009 });
    CHECK(numbers_of({ blob.positions, moved, turned }, blob.triangles) == Numbers { 3010 });

    const TemporaryFolder folder;
    write_off(folder / "a.off", blob.positions, blob.triangles);
    write_off(folder / "b.off", moved, blob.triangles);
    LoadOptions options;
    options.align = false;
    CHECK(load_poses({ folder / "a.off", folder / "b.off" }, options).pose_count() == 2);
}

TEST_CASE("rounding of the coordinates")
{
    Positions positions(1, 3);
    positions << 0.5, 1, -2;
    CHECK(coordinate_rounding(positions) == 2 * 0x1p-24);
    positions << 0.1, 1, -2;
    CHECK(coordinate_rounding(positions) == 2 * 0x1p-53);
}
