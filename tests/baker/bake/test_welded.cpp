// Surfaces as games have them: split at seams, with faces that have no energy, edges of three faces and vertices of none.
// What is elastic of them, that it is the same as of a clean mesh, and that files are drawn as they are.
#include "../input/io/files.h"
#include "../tube.h"
#include "bake/make_energy.h"

#include "bake/bake.h"
#include "bake/certificate.h"
#include "base/mesh/weld.h"
#include "input/io/encode_ply.h"
#include "input/poses/load_poses.h"
#include "output/asset/asset_facts.h"
#include "output/asset/runtime_blender.h"

#include <algorithm>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

// A mesh in several poses, written to files and loaded.
struct Source {
    std::vector<Positions> poses;
    std::vector<Triangle> faces;

    PoseSet load(std::vector<Diagnostic>* warnings = nullptr, const LoadOptions& options = {}) const
    {
        const pliant_test::TemporaryFolder folder;
        std::vector<std::string> paths;
        for (const Positions& pose : poses) {
            std::string text;
            char line[128];
            for (Eigen::Index v = 0; v < pose.rows(); ++v) {
                std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", pose(v, 0), pose(v, 1), pose(v, 2));
                text += line;
            }
            for (const Triangle& t : faces) {
                std::snprintf(line, sizeof line, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
                text += line;
            }
            paths.push_back(folder / ("pose" + std::to_string(paths.size()) + ".obj"));
            pliant_test::write_bytes(paths.back(), text);
        }
        return load_poses(paths, options, warnings);
    }

    // Every face with vertices of its own.
    Source split() const
    {
        Source out;
        for (const Positions& pose : poses) {
            Positions corners(3 * Eigen::Index(faces.size()), 3);
            for (std::size_t c = 0; c < 3 * faces.size(); ++c) corners.row(Eigen::Index(c)) = pose.row(faces[c / 3][c % 3]);
            out.poses.push_back(corners);
        }
        for (std::uint32_t f = 0; f < faces.size(); ++f) out.faces.push_back({ 3 * f, 3 * f + 1, 3 * f + 2 });
        return out;
    }

    void add_vertex(const Eigen::RowVector3d& position)
    {
        for (Positions& pose : poses) {
            pose.conservativeResize(pose.rows() + 1, 3);
            pose.bottomRows(1) = position;
        }
    }
};

Source small_tube()
{
    const Tube tube { 10, 6 };
    return { { tube.pose(0, 0), tube.pose(1.2, 0.5) }, tube.triangles() };
}

std::vector<int> numbers_of(const std::vector<Diagnostic>& diagnostics)
{
    std::vector<int> numbers;
    for (const Diagnostic& diagnostic : diagnostics) numbers.push_back(diagnostic.number);
    return numbers;
}

std::vector<std::uint32_t> weld_all(const std::vector<Positions>& poses, double tolerance)
{
    std::vector<const Positions*> pointers;
    for (const Positions& pose : poses) pointers.push_back(&pose);
    return weld(pointers, tolerance);
}

double mean_energy(const PoseSet& poses)
{
    const NormalizedPoses set = normalize(poses);
    return energy_value(*make_energy(set, {}), equal_weights(2), set.shapes[1]);
}

BakeOptions quick_bake()
{
    BakeOptions options;
    options.energy.solver = SolverKind::eigen;
    options.dimension = 4;
    options.element_count = 24;
    options.check_count = 3;
    options.fresh_count = 1;
    options.position_error = 0; // rows and poses are compared to the bit, or nearly
    return options;
}

} // namespace

TEST_CASE("vertices are one if they lie on each other in all poses")
{
    using Targets = std::vector<std::uint32_t>;
    Positions a(6, 3), b(6, 3);
    a << 0, 0, 0, 3, 4, 0, 0, 0, 0, 3, 4, 0, 0, 0, 0, 3, 4, 0;
    b = a;
    CHECK(weld_all({ a, b }, 1e-6) == Targets { 0, 1, 0, 1, 0, 1 });
    CHECK(weld_all({ a, b }, 0) == Targets { 0, 1, 2, 3, 4, 5 });
    b(2, 2) = 1; // touches in one pose only
    CHECK(weld_all({ a, b }, 1e-6) == Targets { 0, 1, 2, 1, 0, 1 });
    CHECK(weld_all({ b, a }, 1e-6) == Targets { 0, 1, 2, 1, 0, 1 });

    // Diagonal 5: within 5e-6. A chain of short steps does not join its ends.
    a << 0, 0, 0, 3, 4, 0, 0, 4e-6, 0, 0, 8e-6, 0, 0, 12e-6, 0, 0, 1.2e-5, 1e-3;
    const Targets chain = weld_all({ a, a }, 1e-6);
    CHECK(chain[0] == chain[2]);
    CHECK(chain[3] == chain[4]);
    CHECK(chain[0] != chain[4]);
    CHECK(chain[1] == 1);
    CHECK(chain[5] == 5);
    // Neither units nor place matter.
    CHECK(weld_all({ 1e4 * a, 1e-4 * a }, 1e-6) == chain);
}

TEST_CASE("a flat-shaded mesh has the elastic mesh of the joined one, and is drawn as it is")
{
    const Source tube = small_tube(), split = tube.split();
    std::vector<Diagnostic> warnings;
    const PoseSet poses = split.load(&warnings);
    CHECK(numbers_of(warnings) == std::vector<int> { 2220 });
    CHECK(poses.vertex_count() == 62);
    CHECK(poses.repairs.welded_count == 360 - 62);
    CHECK(poses.triangles.size() == tube.faces.size());
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t f = 0; f < tube.faces.size(); ++f)
            for (std::size_t c = 0; c < 3; ++c)
                REQUIRE(poses.positions[k].row(poses.triangles[f][c]) == tube.poses[k].row(tube.faces[f][c]));
    CHECK(mean_energy(poses) == doctest::Approx(mean_energy(tube.load())).epsilon(1e-12));

    REQUIRE(poses.render_mesh);
    CHECK(poses.render_mesh->triangles == split.faces);
    CHECK(render_mesh_positions(*poses.render_mesh, poses.positions[1]) == split.poses[1]);
    for (std::uint32_t v = 0; v < poses.vertex_count(); ++v)
        REQUIRE(split.poses[1].row(poses.file_number(v)) == poses.positions[1].row(v));
    CHECK(encode_ply(poses.positions[1], poses) == encode_ply(split.poses[1], poses.polygons));

    // A mesh without seams is taken as it is.
    const PoseSet joined = tube.load();
    CHECK(!joined.render_mesh);
    CHECK(joined.source_vertices.empty());
    CHECK(joined.triangles == tube.faces);
    LoadOptions apart;
    apart.weld_tolerance = 0;
    CHECK(split.load(nullptr, apart).repairs.component_count == 120);
}

TEST_CASE("faces without an energy are left out and change nothing")
{
    Source tube = small_tube();
    const double energy = mean_energy(tube.load());
    const Triangle t = tube.faces[7];
    tube.add_vertex(0.5 * (tube.poses[0].row(t[0]) + tube.poses[0].row(t[1])));
    tube.poses[1].row(62) = tube.poses[1].row(t[0]); // flat in pose 1, and nothing else has the vertex
    tube.faces.push_back({ t[0], t[1], 62 });
    tube.faces.push_back({ t[0], t[1], t[0] });
    tube.faces.push_back({ t[1], t[2], t[0] });
    tube.faces.push_back({ t[2], t[1], t[0] });
    std::vector<Diagnostic> warnings;
    const PoseSet poses = tube.load(&warnings);
    CHECK(numbers_of(warnings) == std::vector<int> { 2201, 2202, 2205, 2207 });
    CHECK(poses.repairs.repeated_count == 1);
    CHECK(poses.repairs.flat_count == 1);
    CHECK(poses.repairs.duplicate_count == 2);
    CHECK(poses.repairs.lone_vertex_count == 1);
    CHECK(poses.repairs.component_count == 1);
    CHECK(poses.triangles == small_tube().faces);
    REQUIRE(poses.render_mesh);
    CHECK(poses.render_mesh->triangles == tube.faces);
    CHECK(mean_energy(poses) == doctest::Approx(energy).epsilon(1e-3)); // the lone vertex has a part in the alignment
    const NormalizedPoses set = normalize(poses);
    CHECK(set.masses.minCoeff() > 0);
    CHECK(set.masses.sum() == doctest::Approx(1).epsilon(1e-14));
    CHECK(set.masses[62] == doctest::Approx(1e-3 / 62).epsilon(0.05));
}

TEST_CASE("around an edge of several faces each bends against the next")
{
    // Edge 0 1 along x; faces at 0, 90, 180 and 225 degrees around it, some turned over.
    Shape rest(18);
    rest << 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.4, 0, 1, 0.3, -1, 0, 0.6, -1, -1;
    const std::vector<Triangle> faces = { { 0, 1, 2 }, { 0, 1, 4 }, { 1, 0, 3 }, { 1, 0, 5 } };
    const auto opposite = [](const std::vector<Hinge>& hinges) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
        for (const Hinge& h : hinges) pairs.push_back(std::minmax(h.vertices[2], h.vertices[3]));
        std::sort(pairs.begin(), pairs.end());
        return pairs;
    };
    using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
    std::vector<std::uint32_t> order = { 0, 1, 2, 3 };
    do {
        std::vector<Triangle> permuted;
        for (const std::uint32_t f : order) permuted.push_back(faces[f]);
        const std::vector<Hinge> hinges = find_hinges(permuted, rest);
        REQUIRE(opposite(hinges) == Pairs { { 2, 3 }, { 2, 5 }, { 3, 4 }, { 4, 5 } });
        for (const Hinge& h : hinges) REQUIRE(h.faces[0] < h.faces[1]);
    } while (std::next_permutation(order.begin(), order.end()));
    // Two faces are one hinge, whichever way round they go.
    CHECK(opposite(find_hinges({ faces[0], faces[1] }, rest)) == Pairs { { 2, 4 } });
    CHECK(opposite(find_hinges({ faces[0], faces[2] }, rest)) == Pairs { { 2, 3 } });
}

TEST_CASE("faces that are turned over have the same energy")
{
    Source tube = small_tube();
    const double energy = mean_energy(tube.load());
    for (std::size_t f = 0; f < tube.faces.size(); f += 3) std::swap(tube.faces[f][0], tube.faces[f][1]);
    std::vector<Diagnostic> warnings;
    const PoseSet poses = tube.load(&warnings);
    CHECK(numbers_of(warnings) == std::vector<int> { 2204 });
    CHECK(mean_energy(poses) == doctest::Approx(energy).epsilon(1e-12));
}

TEST_CASE("a seam is no part of a fixed vertex's number")
{
    const Source split = small_tube().split();
    const pliant_test::TemporaryFolder folder;
    LoadOptions options;
    options.fixed_path = folder / "fixed.txt";
    pliant_test::write_bytes(options.fixed_path, "0\n1\n2\n3\n"); // 0 and 3 are one
    try {
        split.load(nullptr, options);
        FAIL("they move");
    } catch (const Failure& failure) {
        CHECK(failure.diagnostics().back().number == 3013);
    }
    Source still = split;
    still.poses[1].topRows(9) = still.poses[0].topRows(9);
    pliant_test::write_bytes(options.fixed_path, "0\n2\n1\n");
    const PoseSet poses = still.load(nullptr, options);
    REQUIRE(poses.fixed_vertices.size() == 3);
    for (const std::uint32_t v : poses.fixed_vertices) CHECK(poses.file_number(v) < 3);
}

TEST_CASE("a flat-shaded mesh bakes as the joined one does")
{
    const PoseSet split = small_tube().split().load();
    PoseSet joined = split; // the same numbering, so the same arithmetic
    joined.render_mesh = nullptr;
    joined.source_vertices.clear();
    joined.repairs = {};
    joined.polygons = Polygons();
    for (const Triangle& t : joined.triangles) {
        joined.polygons.indices.insert(joined.polygons.indices.end(), t.begin(), t.end());
        joined.polygons.offsets.push_back(std::uint32_t(joined.polygons.indices.size()));
    }
    Progress silent;
    const BakedAsset one = bake(split, quick_bake(), silent), other = bake(joined, quick_bake(), silent);
    CHECK(one.report.check.mean_error == other.report.check.mean_error);
    CHECK(one.report.input.vertex_count == 62);
    RuntimeBlender drawn(one.bytes, "split", true), plain(other.bytes, "joined", true);
    CHECK(drawn.asset().vertex_count == 360);
    CHECK(drawn.asset().triangle_count == 120);
    CHECK(drawn.faces().indices == split.polygons.indices);
    for (const float w : { 0.f, 0.3f, 0.5f, 1.f }) {
        const std::vector<float> q = drawn.solve({ 1 - w, w }, false);
        CHECK(q == plain.solve({ 1 - w, w }, false));
        const std::vector<float> rows = drawn.positions(q), vertices = plain.positions(q);
        for (std::size_t v = 0; v < split.render_mesh->embedding.count(); ++v)
            for (std::size_t c = 0; c < 3; ++c)
                REQUIRE(rows[3 * v + c] == vertices[3 * split.render_mesh->embedding.corners[v][0] + c]);
    }
    CHECK(drawn.certificate().find("\"welded_vertices\": 298") != std::string::npos);
    CHECK(plain.certificate().find("\"elastic\"") == std::string::npos);
    CHECK(read_energy_options(drawn.certificate(), false, "split").weld_tolerance == default_weld_tolerance);
    CHECK(read_energy_options(plain.certificate(), false, "joined").weld_tolerance == 0);
    CHECK(!has_render_mesh(drawn.certificate()));
}

TEST_CASE("the average does not depend on how the file splits and numbers its vertices")
{
    const Source tube = small_tube();
    const PoseSet split = tube.split().load(), joined = tube.load();
    const auto average = [](const PoseSet& poses) {
        const NormalizedPoses set = normalize(poses);
        const std::unique_ptr<Energy> energy = make_energy(set, {});
        SolverPool pool(*energy, set, SolverKind::eigen);
        AverageFamily family(pool, {}, nullptr);
        REQUIRE(family.mean().has_converged);
        return to_input_units(set, family.mean().y);
    };
    const Positions rows = render_mesh_positions(*split.render_mesh, average(split)), vertices = average(joined);
    for (std::size_t c = 0; c < 3 * tube.faces.size(); ++c)
        REQUIRE((rows.row(Eigen::Index(c)) - vertices.row(tube.faces[c / 3][c % 3])).norm() < 1e-6 * 6);
}

TEST_CASE("a fin on three faces bakes, reproduces its poses and keeps them apart")
{
    Source tube = small_tube();
    const Triangle t = tube.faces[20];
    for (std::size_t k = 0; k < 2; ++k) { // a blade that stands out of an edge
        Positions& pose = tube.poses[k];
        const Eigen::RowVector3d middle = 0.5 * (pose.row(t[0]) + pose.row(t[1]));
        Eigen::RowVector3d inside = pose.colwise().mean();
        inside[2] = middle[2];
        pose.conservativeResize(63, 3);
        pose.row(62) = middle + 0.4 * (middle - inside).normalized();
    }
    tube.faces.push_back({ t[0], t[1], 62 });
    std::vector<Diagnostic> warnings;
    const PoseSet poses = tube.load(&warnings);
    CHECK(numbers_of(warnings) == std::vector<int> { 2203 });
    CHECK(!poses.render_mesh);
    Progress silent;
    const BakedAsset asset = bake(poses, quick_bake(), silent);
    CHECK(asset.report.check.mean_error < 1e-2);
    RuntimeBlender blender(asset.bytes, "fin", true);
    for (std::size_t k = 0; k < 2; ++k) {
        const float* q = pliant_asset_pose_coordinates(&blender.asset(), std::uint32_t(k));
        const NormalizedPoses set = normalize(poses);
        const Shape shape = from_input_units(set, blender.positions(std::vector<float>(q, q + blender.asset().dimension)));
        CHECK((shape - set.shapes[k]).norm() < 1e-5 * set.shapes[k].norm());
    }
    CHECK(asset.report.certificate.find("\"edges_of_many_faces\": 1") != std::string::npos);
}
