// From files of tetrahedra to a set of poses: the boundary, the numbering, orientation, fixed vertices.
#include <doctest/doctest.h>

#include "files.h"
#include "input/io/encode_msh.h"
#include "input/io/encode_ply.h"
#include "input/io/read_mesh.h"
#include "input/poses/load_poses.h"
#include "skip.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>
#include <set>

using namespace pliant;
using pliant_test::number_of;
using pliant_test::TemporaryFolder;

namespace {

struct Solid {
    Positions positions;
    std::vector<Tetrahedron> tets;
};

// A warped block of n^3 cubes, each cut into six tetrahedra around a diagonal; vertices in a random order.
Solid make_block(std::uint32_t n)
{
    const std::uint32_t m = n + 1;
    std::vector<std::uint32_t> places(m * m * m);
    std::iota(places.begin(), places.end(), 0u);
    std::shuffle(places.begin(), places.end(), std::mt19937(5));
    const auto vertex = [&](const std::array<std::uint32_t, 3>& at) { return places[(at[0] * m + at[1]) * m + at[2]]; };
    Solid solid;
    solid.positions.resize(m * m * m, 3);
    for (std::uint32_t x = 0; x < m; ++x)
        for (std::uint32_t y = 0; y < m; ++y)
            for (std::uint32_t z = 0; z < m; ++z)
                solid.positions.row(vertex({ x, y, z })) << x + 0.1 * std::sin(y + 2.0 * z), y + 0.1 * x * z, 1.5 * z;
    const std::array<std::array<std::size_t, 3>, 6> orders {
        { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } }
    };
    for (std::uint32_t cube = 0; cube < n * n * n; ++cube) {
        for (std::size_t order = 0; order < 6; ++order) {
            std::array<std::uint32_t, 3> at { cube / n / n, cube / n % n, cube % n };
            Tetrahedron tet { vertex(at) };
            for (std::size_t i = 0; i < 3; ++i) {
                ++at[orders[order][i]];
                tet[i + 1] = vertex(at);
            }
            if (order >= 3) std::swap(tet[2], tet[3]);
            solid.tets.push_back(tet);
        }
    }
    return solid;
}

Positions bent(const Positions& positions, double amount)
{
    Positions result = positions;
    for (Eigen::Index v = 0; v < result.rows(); ++v) result(v, 0) += amount * result(v, 2) * result(v, 2);
    return result;
}

// Bent along the longest side of the box, whatever its size; keeps all volumes.
Positions sheared(const Positions& positions)
{
    Eigen::Index axis = 0;
    const double length = (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).maxCoeff(&axis);
    Positions result = positions;
    result.col((axis + 1) % 3).array() += 0.3 / length * positions.col(axis).array().square();
    return result;
}

double volume(const Positions& positions, const Tetrahedron& t)
{
    const Eigen::RowVector3d a = positions.row(t[0]);
    const Eigen::Vector3d u = positions.row(t[1]) - a, v = positions.row(t[2]) - a, w = positions.row(t[3]) - a;
    return u.dot(v.cross(w)) / 6;
}

double volume_inside(const Positions& positions, const std::vector<Triangle>& triangles)
{
    double result = 0;
    for (const Triangle& t : triangles) {
        const Eigen::Vector3d a = positions.row(t[0]), b = positions.row(t[1]), c = positions.row(t[2]);
        result += a.dot(b.cross(c)) / 6;
    }
    return result;
}

struct Loaded {
    PoseSet poses;
    std::vector<Diagnostic> diagnostics; // errors too
};

// Writes the poses as Gmsh files, and vertices to be fixed; loads them.
Loaded load(const std::vector<Solid>& solids, const std::vector<std::uint32_t>& fixed = {}, bool align = true)
{
    const TemporaryFolder folder;
    std::vector<std::string> paths;
    for (const Solid& solid : solids) {
        paths.push_back(folder / ("pose" + std::to_string(paths.size()) + ".msh"));
        pliant_test::write_bytes(paths.back(), encode_msh(solid.positions, solid.tets));
    }
    LoadOptions options;
    options.align = align;
    if (!fixed.empty()) {
        options.fixed_path = folder / "fixed.txt";
        std::string text = "# fixed\n";
        for (const std::uint32_t vertex : fixed) text += std::to_string(vertex) + " # a vertex\r\n\n";
        pliant_test::write_bytes(options.fixed_path, text);
    }
    Loaded result;
    try {
        result.poses = load_poses(paths, options, &result.diagnostics);
    } catch (const Failure& failure) {
        result.diagnostics = failure.diagnostics();
    }
    return result;
}

std::vector<int> numbers_of(const Loaded& loaded)
{
    std::vector<int> numbers;
    for (const Diagnostic& diagnostic : loaded.diagnostics) numbers.push_back(diagnostic.number);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
}

using Numbers = std::vector<int>;

// What load_poses promises of a solid.
void check_promises(const PoseSet& poses, const std::vector<Positions>& in_files)
{
    REQUIRE(poses.is_solid());
    const std::size_t count = poses.vertex_count(), outside = poses.boundary_vertex_count;
    REQUIRE(poses.source_vertices.size() == count);
    const auto middle = poses.source_vertices.begin() + static_cast<std::ptrdiff_t>(outside);
    CHECK(std::is_sorted(poses.source_vertices.begin(), middle));
    CHECK(std::is_sorted(middle, poses.source_vertices.end()));
    CHECK(std::set<std::uint32_t>(poses.source_vertices.begin(), poses.source_vertices.end()).size() == count);
    std::set<std::uint32_t> used;
    std::vector<std::uint32_t> corners;
    for (const Triangle& triangle : poses.triangles) {
        used.insert(triangle.begin(), triangle.end());
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    }
    CHECK(used.size() == outside);
    CHECK(*used.rbegin() == outside - 1);
    CHECK(poses.polygons.indices == corners);
    CHECK(poses.polygons.count() == poses.triangles.size());
    for (std::size_t k = 0; k < poses.pose_count(); ++k) {
        double total = 0;
        for (const Tetrahedron& tet : poses.tets) {
            const double v = volume(poses.positions[k], tet);
            REQUIRE(v > 0);
            total += v;
        }
        CHECK(volume_inside(poses.positions[k], poses.triangles) == doctest::Approx(total).epsilon(1e-9)); // outward, closed
        for (std::size_t v = 0; v < count; ++v)
            REQUIRE(poses.positions[k].row(Eigen::Index(v)) == in_files[k].row(poses.source_vertices[v]));
    }
}

} // namespace

TEST_CASE("the boundary comes first, outward; what lies inside follows")
{
    const Solid block = make_block(3);
    const Positions pose = bent(block.positions, 0.1);
    const Loaded loaded = load({ block, { pose, block.tets } });
    REQUIRE(loaded.diagnostics.empty());
    const PoseSet& poses = loaded.poses;
    CHECK(poses.boundary_vertex_count == 64 - 8);
    CHECK(poses.triangles.size() == 6 * 9 * 2);
    CHECK(poses.fixed_vertices.empty());
    check_promises(poses, { block.positions, pose });
    for (std::size_t t = 0; t < poses.tets.size(); ++t) {
        for (std::size_t i = 0; i < 4; ++i) CHECK(poses.source_vertices[poses.tets[t][i]] == block.tets[t][i]);
    }
}

TEST_CASE("the other convention is turned, alike in all poses; a single inverted one is not")
{
    Solid block = make_block(2);
    for (Tetrahedron& tet : block.tets) std::swap(tet[0], tet[1]);
    const Positions pose = bent(block.positions, 0.1);
    const Loaded loaded = load({ block, { pose, block.tets } });
    CHECK(numbers_of(loaded) == Numbers { 2214 });
    check_promises(loaded.poses, { block.positions, pose });
    // The convention is that of the first pose: a mirrored second one is mirrored.
    const Positions mirrored = pose * Eigen::Vector3d(1, -1, 1).asDiagonal();
    CHECK(numbers_of(load({ block, { mirrored, block.tets } })) == Numbers { 2214, 3007 });
    std::swap(block.tets[4][0], block.tets[4][1]);
    CHECK(numbers_of(load({ block, { pose, block.tets } })) == Numbers { 2213 });
}

TEST_CASE("no verdict depends on the unit of length or on the place")
{
    const Solid block = make_block(2);
    const Positions pose = bent(block.positions, 0.1);
    const Tetrahedron& t = block.tets[9];
    std::vector<std::pair<Numbers, Positions>> cases = { { {}, pose }, { { 3009 }, block.positions } };
    cases.push_back({ { 2212 }, pose }); // a corner in the opposite face
    cases.back().second.row(t[3]) = (pose.row(t[0]) + pose.row(t[1]) + pose.row(t[2])) / 3;
    cases.push_back({ {}, pose }); // nearly there: a thousandth of its height
    cases.back().second.row(t[3]) = 0.999 * (pose.row(t[0]) + pose.row(t[1]) + pose.row(t[2])) / 3 + 0.001 * pose.row(t[3]);
    cases.push_back({ { 3007 }, pose * Eigen::Vector3d(1, 1, -1).asDiagonal() });
    cases.push_back({ { 3008 }, 100 * pose });
    for (const auto& [expected, second] : cases) {
        for (const auto& [scale, offset] :
             { std::pair(1.0, 0.0), std::pair(1e-6, 0.0), std::pair(1e6, 0.0), std::pair(3.7, 1e5), std::pair(1e-6, 1.0) }) {
            CAPTURE(scale);
            CAPTURE(offset);
            const Positions a = (scale * block.positions.array() + offset).matrix(),
                            b = (scale * second.array() + offset).matrix();
            Numbers found = numbers_of(load({ { a, block.tets }, { b, block.tets } }));
            // A corner that moves into the opposite face inverts tetrahedra beyond.
            found.erase(std::remove(found.begin(), found.end(), 2213), found.end());
            if (offset != 0)
                found.erase(std::remove(found.begin(), found.end(), 2209), found.end()); // blends are rounded there
            found.erase(std::unique(found.begin(), found.end()), found.end());
            CHECK(found == expected);
        }
    }
}

TEST_CASE("a shuffled pose does not correspond")
{
    const Solid block = make_block(3);
    Solid shuffled = block;
    std::vector<Eigen::Index> order(static_cast<std::size_t>(block.positions.rows()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(3));
    for (std::size_t v = 0; v < order.size(); ++v) shuffled.positions.row(Eigen::Index(v)) = block.positions.row(order[v]);
    const Numbers found = numbers_of(load({ block, shuffled }));
    CHECK(std::count(found.begin(), found.end(), 2213) == 1);
    // The same with its tetrahedra: other numbers, which is proven.
    for (Tetrahedron& tet : shuffled.tets) {
        for (std::uint32_t& v : tet)
            v = static_cast<std::uint32_t>(std::find(order.begin(), order.end(), Eigen::Index(v)) - order.begin());
    }
    const Loaded renumbered = load({ block, shuffled });
    CHECK(numbers_of(renumbered) == Numbers { 3005 });
    CHECK(renumbered.diagnostics[0].what.find("is the same solid in a different order: tetrahedron 0 is ") == 0);
}

TEST_CASE("fixed vertices: in the set's numbering, in the same place in all poses")
{
    const Solid block = make_block(3);
    std::vector<std::uint32_t> fixed;
    for (Eigen::Index v = 0; v < block.positions.rows(); ++v) {
        if (block.positions(v, 2) == 0) fixed.push_back(std::uint32_t(v));
    }
    REQUIRE(fixed.size() == 16);
    Positions pose = bent(block.positions, 0.1);
    pose(fixed[3], 1) += 1e-6; // the diagonal is about 6
    std::vector<std::uint32_t> twice(fixed.rbegin(), fixed.rend());
    twice.insert(twice.end(), fixed.begin(), fixed.end());
    const Loaded loaded = load({ block, { pose, block.tets } }, twice);
    REQUIRE(loaded.diagnostics.empty());
    const PoseSet& poses = loaded.poses;
    REQUIRE(poses.fixed_vertices.size() == 16);
    CHECK(std::is_sorted(poses.fixed_vertices.begin(), poses.fixed_vertices.end()));
    std::set<std::uint32_t> sources;
    for (const std::uint32_t v : poses.fixed_vertices) {
        sources.insert(poses.source_vertices[v]);
        CHECK(poses.positions[1].row(v) == block.positions.row(poses.source_vertices[v]));
    }
    CHECK(sources == std::set<std::uint32_t>(fixed.begin(), fixed.end()));

    pose(fixed[3], 1) += 1e-3;
    const Loaded moved = load({ block, { pose, block.tets } }, fixed);
    CHECK(numbers_of(moved) == Numbers { 3013 });
    CHECK(moved.diagnostics[0].what.find("vertex " + std::to_string(fixed[3]) + " is fixed") == 0);
    CHECK(numbers_of(load({ block, { pose, block.tets } }, { 0, 1 })) == Numbers { 2604, 3013 });
    // Nothing is aligned, so a turned copy is another pose.
    const std::vector<std::uint32_t> wrong = { 0, 1, 64 };
    CHECK(numbers_of(load({ block, { pose, block.tets } }, wrong)) == Numbers { 2603 });
}

TEST_CASE("fixed vertices of a surface; single precision is no reason to refuse")
{
    const TemporaryFolder folder;
    Positions rest(5, 3), pose(5, 3);
    rest << 0, 0, 100, 1, 0, 100, 0, 1, 100, 1, 1, 100, 2, 2, 100;
    pose = rest;
    pose(1, 2) += 8e-6; // one step of a float there
    pose(4, 2) += 1;
    Polygons faces;
    faces.indices = { 0, 1, 2, 1, 3, 2, 1, 4, 3 };
    faces.offsets = { 0, 3, 6, 9 };
    pliant_test::write_bytes(folder / "a.ply", encode_ply(rest, faces));
    pliant_test::write_bytes(folder / "b.ply", encode_ply(pose, faces));
    pliant_test::write_bytes(folder / "fixed.txt", "2\n0\n1");
    LoadOptions options;
    options.fixed_path = folder / "fixed.txt";
    const PoseSet poses = load_poses({ folder / "a.ply", folder / "b.ply" }, options);
    CHECK(poses.fixed_vertices == std::vector<std::uint32_t> { 0, 1, 2 });
    CHECK(poses.positions[1].topRows(3) == poses.positions[0].topRows(3));
    CHECK(poses.positions[1](4, 2) == 101);
    pliant_test::write_bytes(folder / "fixed.txt", "2\n0\n4");
    CHECK(number_of([&] { load_poses({ folder / "a.ply", folder / "b.ply" }, options); }) == 3013);
    pliant_test::write_bytes(folder / "fixed.txt", "0\n3\n4");
    CHECK(number_of([&] { load_poses({ folder / "a.ply", folder / "b.ply" }, options); }) == 2604);
    pliant_test::write_bytes(folder / "fixed.txt", "0\n1\n2\n3\n4");
    CHECK(number_of([&] { load_poses({ folder / "a.ply", folder / "b.ply" }, options); }) == 2605);
    pliant_test::write_bytes(folder / "fixed.txt", "0\n1.0\n2");
    CHECK(number_of([&] { load_poses({ folder / "a.ply", folder / "b.ply" }, options); }) == 2602);
}

TEST_CASE("a shape of a solid is written as its boundary, or with all vertices as the files count them")
{
    const TemporaryFolder folder;
    const Solid block = make_block(3);
    const Loaded loaded = load({ block, { bent(block.positions, 0.1), block.tets } });
    const PoseSet& poses = loaded.poses;
    pliant_test::write_bytes(folder / "a.ply", encode_ply(poses.positions[1], poses));
    const MeshFile boundary = read_mesh(folder / "a.ply");
    CHECK(boundary.positions.rows() == 56);
    CHECK(boundary.positions == poses.positions[1].topRows(56).cast<float>().cast<double>());
    CHECK(boundary.faces.indices == poses.polygons.indices);

    pliant_test::write_bytes(folder / "b.ply", encode_ply(poses.positions[0], poses, true));
    const MeshFile all = read_mesh(folder / "b.ply");
    CHECK(all.positions == block.positions.cast<float>().cast<double>());
    REQUIRE(all.faces.count() == poses.triangles.size());
    for (std::size_t i = 0; i < all.faces.indices.size(); ++i)
        REQUIRE(all.faces.indices[i] == poses.source_vertices[poses.polygons.indices[i]]);
}

TEST_CASE("real solids load, with a bent second pose")
{
    const std::string data = pliant_test::data_folder();
    if (data.empty()) PLIANT_SKIP("no data: set PLIANT_DATA");
    struct Case {
        const char* file;
        Eigen::Index vertices;
        std::size_t tets, left_out;
    };
    for (const Case& c :
         { Case { "tet_small/beam3_tet.veg", 208, 450, 0 }, Case { "tet_small/bar_10x1x1.msh", 1088, 3646, 1 },
           Case { "tet_mid/bear.msh", 1986, 5354, 0 }, Case { "tet_mid/rod300x33.msh", 13333, 50511, 0 },
           Case { "tet_mid/simpleBridge.veg", 4000, 12827, 0 }, Case { "tet_mid/spot.msh", 15781, 58365, 0 } }) {
        CAPTURE(c.file);
        const std::string path = data + "/" + c.file;
        if (!std::filesystem::exists(path)) PLIANT_SKIP("no solids among the data");
        const MeshFile mesh = read_mesh(path);
        CHECK(mesh.positions.rows() == c.vertices);
        CHECK(mesh.tets.size() == c.tets);
        const bool is_vega = path.substr(path.size() - 4) == ".veg";
        CHECK(mesh.regions.of_tet.size() == (is_vega ? c.tets : 0));
        const TemporaryFolder folder;
        const Positions pose = sheared(mesh.positions);
        pliant_test::write_bytes(folder / "pose.msh", encode_msh(pose, mesh.tets));
        std::vector<Diagnostic> warnings;
        const PoseSet poses = load_poses({ path, folder / "pose.msh" }, {}, &warnings);
        CHECK(warnings.size() == c.left_out);
        check_promises(poses, { mesh.positions, pose });
    }
}

TEST_CASE("a Vega solid has the surface that came with it")
{
    const std::string data = pliant_test::data_folder();
    if (data.empty() || !std::filesystem::exists(data + "/tet_small/beam3_tet_surface.obj"))
        PLIANT_SKIP("no data: set PLIANT_DATA");
    const MeshFile solid = read_mesh(data + "/tet_small/beam3_tet.veg"),
                   surface = read_mesh(data + "/tet_small/beam3_tet_surface.obj");
    const Loaded loaded = load({ { solid.positions, solid.tets }, { sheared(solid.positions), solid.tets } });
    REQUIRE(loaded.diagnostics.empty());
    CHECK(loaded.poses.triangles.size() == surface.faces.count());
    CHECK(loaded.poses.boundary_vertex_count == std::size_t(surface.positions.rows()));
    std::vector<Triangle> faces;
    for (std::size_t f = 0; f < surface.faces.count(); ++f)
        faces.push_back(
            { surface.faces.indices[3 * f], surface.faces.indices[3 * f + 1], surface.faces.indices[3 * f + 2] });
    const double volume = volume_inside(surface.positions, faces);
    CHECK(volume == doctest::Approx(volume_inside(loaded.poses.positions[0], loaded.poses.triangles)).epsilon(1e-5));
}
