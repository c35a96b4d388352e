// A body cut into parts of three materials, each compressed with a grid of its own: it is one body all the same.
#include <doctest/doctest.h>

#include "../../tube.h"
#include "../io/files.h"
#include "base/mesh/render_mesh.h"
#include "base/mesh/weld_seams.h"
#include "glb_samples.h"
#include "input/poses/load_poses.h"
#include "input/poses/pose_source.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <meshoptimizer.h>
#include <numeric>

using namespace pliant;
using pliant_test::GlbBuilder, pliant_test::Json;

namespace {

const Tube body { 10, 6 };
constexpr std::size_t copy_count = 6 + 2 + 11; // above the cut, where three parts meet once more; between the two sides

// Faces and vertices of one part, in the body's order.
struct Part {
    std::vector<std::uint32_t> corners, vertices;
    std::vector<float> rest, moves;
};

// 0: below; 1 and 2: the two sides above.
std::uint32_t part_of(const Triangle& t)
{
    const auto last_ring = [](std::uint32_t v) { return v / 6; };
    const std::uint32_t lowest = std::min({ last_ring(t[0]), last_ring(t[1]), last_ring(t[2]) });
    if (lowest < 4 || t[0] == 60) return 0;
    double y = 0;
    for (const std::uint32_t v : t) y += body.pose(0, 0)(v, 1);
    return y > 0 ? 1 : 2;
}

Part part(std::uint32_t number)
{
    Part out;
    const Positions rest = body.pose(0, 0), bent = body.pose(1.2, 0.5);
    for (const Triangle& t : body.triangles())
        if (part_of(t) == number) out.corners.insert(out.corners.end(), t.begin(), t.end());
    out.vertices = out.corners;
    std::sort(out.vertices.begin(), out.vertices.end());
    out.vertices.erase(std::unique(out.vertices.begin(), out.vertices.end()), out.vertices.end());
    for (std::uint32_t& c : out.corners)
        c = static_cast<std::uint32_t>(std::lower_bound(out.vertices.begin(), out.vertices.end(), c) - out.vertices.begin());
    for (const std::uint32_t v : out.vertices)
        for (int i = 0; i < 3; ++i) {
            out.rest.push_back(static_cast<float>(rest(v, i)));
            out.moves.push_back(static_cast<float>(bent(v, i) - rest(v, i)));
        }
    return out;
}

std::vector<std::int16_t> rounded(const std::vector<float>& values, float low, float step)
{
    std::vector<std::int16_t> out;
    for (const float value : values) out.push_back(static_cast<std::int16_t>(std::lround((value - low) / step)));
    return out;
}

// As KHR_mesh_quantization has it: whole numbers, and a node that scales them.
Json shorts(GlbBuilder& glb, const Part& part, Json& node)
{
    const auto [low, high] = std::minmax_element(part.rest.begin(), part.rest.end());
    const float step = (*high - *low) / 4095;
    node["translation"] = { *low, *low, *low };
    node["scale"] = { step, step, step };
    Json primitive = Json::object(), target = Json::object();
    primitive["attributes"]["POSITION"] = glb.add(rounded(part.rest, *low, step), 5122, 3, "VEC3");
    primitive["indices"] = glb.add(part.corners, 5125, 1, "SCALAR");
    target["POSITION"] = glb.add(rounded(part.moves, 0, step), 5122, 3, "VEC3");
    primitive["targets"].push_back(target);
    return primitive;
}

// As gltf-transform does by default: rounded to 12 bits, the lowest of 15 repeat the highest.
Json widened_shorts(GlbBuilder& glb, const Part& part, Json& node)
{
    float half = 0;
    for (const std::vector<float>* values : { &part.rest, &part.moves })
        for (const float value : *values) half = std::max(half, std::abs(value));
    node["scale"] = { half, half, half };
    const auto widened = [&](const std::vector<float>& values) {
        std::vector<std::int16_t> out;
        for (const float value : values) {
            const int kept = static_cast<int>(std::lround(std::abs(value) / half * 4095));
            out.push_back(static_cast<std::int16_t>((kept << 3 | kept >> 9) * (value < 0 ? -1 : 1)));
        }
        return out;
    };
    Json primitive = Json::object(), target = Json::object();
    primitive["attributes"]["POSITION"] = glb.add(widened(part.rest), 5122, 3, "VEC3");
    glb.json["accessors"].back()["normalized"] = true;
    primitive["indices"] = glb.add(part.corners, 5125, 1, "SCALAR");
    target["POSITION"] = glb.add(widened(part.moves), 5122, 3, "VEC3");
    glb.json["accessors"].back()["normalized"] = true;
    primitive["targets"].push_back(target);
    return primitive;
}

Json draco_data(GlbBuilder& glb, const Part& part)
{
    const std::unique_ptr<draco::Mesh> mesh = pliant_test::draco_mesh(part.rest, part.corners);
    draco::ExpertEncoder encoder(*mesh);
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING); // keeps the order of vertices, which targets have
    encoder.SetAttributeQuantization(0, 11);
    draco::EncoderBuffer buffer;
    REQUIRE(encoder.EncodeToBuffer(&buffer).ok());
    const std::size_t n = part.vertices.size();
    Json primitive = Json::object(), target = Json::object();
    primitive["attributes"]["POSITION"] = glb.add_accessor(-1, 5126, n, "VEC3");
    primitive["indices"] = glb.add_accessor(-1, 5125, part.corners.size(), "SCALAR");
    Json extension = Json::parse(R"({"attributes":{"POSITION":0}})");
    extension["bufferView"] = glb.add_view({ buffer.data(), buffer.size() });
    primitive["extensions"]["KHR_draco_mesh_compression"] = extension;
    target["POSITION"] = glb.add(part.moves, 5126, 3, "VEC3");
    primitive["targets"].push_back(target);
    return primitive;
}

// As `gltfpack -cc -vpf` stores floats: an exponent for each coordinate, and whole numbers of 12 bits with the sign.
Json exponents(GlbBuilder& glb, const Part& part)
{
    const std::size_t n = part.vertices.size();
    const auto add = [&](const std::vector<float>& values) {
        std::vector<std::uint32_t> words(3 * n);
        for (std::size_t i = 0; i < 3; ++i) {
            float largest = 1e-6F;
            for (std::size_t v = 0; v < n; ++v) largest = std::max(largest, std::abs(values[3 * v + i]));
            const int exponent = std::ilogb(largest) - 10;
            for (std::size_t v = 0; v < n; ++v)
                words[3 * v + i] = std::uint32_t(exponent) << 24
                    | (std::uint32_t(std::lround(std::ldexp(values[3 * v + i], -exponent))) & 0xffffff);
        }
        std::string packed(meshopt_encodeVertexBufferBound(n, 12), 0);
        packed.resize(
            meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(), words.data(), n, 12));
        const int view = glb.add_view(packed);
        Json &json = glb.json["bufferViews"][std::size_t(view)], &extension = json["extensions"]["EXT_meshopt_compression"];
        extension = { { "buffer", 0 }, { "byteStride", 12 }, { "count", n }, { "mode", "ATTRIBUTES" } };
        extension["byteOffset"] = json["byteOffset"];
        extension["byteLength"] = packed.size();
        extension["filter"] = "EXPONENTIAL";
        glb.more_buffers.push_back({ { "byteLength", 12 * n } });
        json["buffer"] = glb.more_buffers.size();
        json["byteOffset"] = 0;
        json["byteLength"] = 12 * n;
        return glb.add_accessor(view, 5126, n, "VEC3");
    };
    glb.json["extensionsRequired"] = { "EXT_meshopt_compression" };
    Json primitive = Json::object(), target = Json::object();
    primitive["attributes"]["POSITION"] = add(part.rest);
    primitive["indices"] = glb.add(part.corners, 5125, 1, "SCALAR");
    target["POSITION"] = add(part.moves);
    primitive["targets"].push_back(target);
    return primitive;
}

// Joint 1 moves no vertex, and is far away and large.
void add_skin(GlbBuilder& glb, Json& primitive, std::size_t vertex_count)
{
    std::vector<std::uint8_t> joints;
    std::vector<float> weights;
    for (std::size_t v = 0; v < vertex_count; ++v) {
        joints.insert(joints.end(), { 0, 1, 0, 0 });
        weights.insert(weights.end(), { 1, 0, 0, 0 });
    }
    primitive["attributes"]["JOINTS_0"] = glb.add(joints, 5121, 4, "VEC4");
    primitive["attributes"]["WEIGHTS_0"] = glb.add(weights, 5126, 4, "VEC4");
}

enum class Rounding { shorts, widened_shorts, draco, exponents };

Json primitive_of(GlbBuilder& glb, Rounding rounding, std::uint32_t number, Json& node)
{
    switch (rounding) {
    case Rounding::shorts: return shorts(glb, part(number), node);
    case Rounding::widened_shorts: return widened_shorts(glb, part(number), node);
    case Rounding::draco: return draco_data(glb, part(number));
    default: return exponents(glb, part(number));
    }
}

std::string compressed_body(Rounding rounding)
{
    GlbBuilder glb;
    glb.json["scenes"][0]["nodes"] = { 0, 1, 2 };
    glb.json["nodes"] = Json::array();
    const bool is_skinned = rounding == Rounding::draco;
    for (std::uint32_t number = 0; number < 3; ++number) {
        Json node = { { "mesh", number } }, mesh = Json::object();
        mesh["primitives"].push_back(primitive_of(glb, rounding, number, node));
        if (is_skinned) {
            add_skin(glb, mesh["primitives"][0], part(number).vertices.size());
            node["skin"] = 0;
        }
        glb.json["meshes"].push_back(mesh);
        glb.json["nodes"].push_back(node);
    }
    if (is_skinned) {
        glb.json["scenes"][0]["nodes"] = { 0, 1, 2, 3, 4 };
        glb.json["nodes"].push_back({ { "name", "body" } });
        glb.json["nodes"].push_back({ { "translation", { 1e3, 0, 0 } }, { "scale", { 50, 50, 50 } } });
        glb.json["skins"].push_back({ { "joints", { 3, 4 } } });
    }
    return glb.glb();
}

} // namespace

TEST_CASE("parts that a compressed file rounds apart are one body, and nothing else is joined")
{
    const pliant_test::TemporaryFolder folder;
    for (const Rounding rounding : { Rounding::shorts, Rounding::widened_shorts, Rounding::draco, Rounding::exponents }) {
        CAPTURE(int(rounding));
        pliant_test::write_bytes(folder / "body.glb", compressed_body(rounding));
        const PoseSet whole = load_poses({ folder / "body.glb" });
        CHECK(whole.repairs.component_count == 1);
        CHECK(whole.repairs.welded_count == copy_count);
        CHECK(whole.vertex_count() == 62);
        CHECK(whole.triangles.size() == body.triangles().size());
        CHECK(whole.render_mesh->embedding.corners.size() == 62 + copy_count);
        LoadOptions apart;
        apart.weld_tolerance = 0;
        CHECK(load_poses({ folder / "body.glb" }, apart).repairs.component_count == 3);
    }
}

namespace {

// The same reach of each part in each pose.
RoundedParts alike(std::vector<std::uint32_t> of_vertex, double reach_together, Eigen::Index pose_count = 1)
{
    const Eigen::Index part_count = *std::max_element(of_vertex.begin(), of_vertex.end()) + 1;
    return { std::move(of_vertex), Eigen::MatrixXd::Constant(part_count, pose_count, reach_together / 2) };
}

std::vector<std::uint32_t> numbers_to(std::uint32_t n)
{
    std::vector<std::uint32_t> out(n);
    std::iota(out.begin(), out.end(), 0u);
    return out;
}

} // namespace

TEST_CASE("numbers that have the pattern of any rounding tell nothing of it")
{
    // Two squares 60 units apart.
    GlbBuilder glb;
    const std::vector<std::int16_t> square = { -32767, -32767, 0, 32767, -32767, 0, 32767, 32767, 0, -32767, 32767, 0 };
    const int positions = glb.add(square, 5122, 3, "VEC3");
    glb.json["accessors"].back()["normalized"] = true;
    const std::vector<float> moves = { 0, 0, 0, 0, 0, 0, 0, 0, 0.5f, 0, 0, 0.5f };
    const int target = glb.add(moves, 5126, 3, "VEC3");
    const int corners = glb.add(std::vector<std::uint32_t> { 0, 1, 2, 0, 2, 3 }, 5125, 1, "SCALAR");
    Json primitive = { { "attributes", { { "POSITION", positions } } }, { "indices", corners } };
    primitive["targets"].push_back({ { "POSITION", target } });
    Json mesh = Json::object();
    mesh["primitives"].push_back(primitive);
    glb.json["meshes"].push_back(mesh);
    glb.json["nodes"].push_back({ { "mesh", 0 }, { "translation", { 0, 0, 60.0 / 32767 } } });
    glb.json["scenes"][0]["nodes"] = { 0, 1 };
    const pliant_test::TemporaryFolder folder;
    pliant_test::write_bytes(folder / "squares.glb", glb.glb());
    CHECK(load_poses({ folder / "squares.glb" }).repairs.welded_count == 0);
    // Beside a part whose numbers tell that programs rounded to 10 bits, a unit of which are 32.
    std::vector<std::int16_t> telling;
    for (int i = 0; i < 30; ++i) telling.push_back(static_cast<std::int16_t>((200 + i) << 5 | (200 + i) >> 5));
    mesh["primitives"][0]["attributes"]["POSITION"] = glb.add(telling, 5122, 3, "VEC3");
    glb.json["accessors"].back()["normalized"] = true;
    mesh["primitives"][0]["indices"] = glb.add(std::vector<std::uint32_t> { 0, 4, 9, 1, 7, 3 }, 5125, 1, "SCALAR");
    mesh["primitives"][0].erase("targets");
    glb.json["meshes"].push_back(mesh);
    glb.json["nodes"].push_back({ { "mesh", 1 }, { "translation", { 1.5, 0, 0 } } });
    glb.json["nodes"][1]["translation"] = { 0, 0, 30.0 / 32767 };
    glb.json["scenes"][0]["nodes"] = { 0, 1, 2 };
    pliant_test::write_bytes(folder / "squares.glb", glb.glb());
    DiagnosticList diagnostics;
    const std::vector<MeshFile> read = read_pose_sources({ folder / "squares.glb" }, Blend::layers, diagnostics).meshes;
    REQUIRE(read.size() == 2);
    for (const double step : read[0].position_steps) CHECK(step == doctest::Approx(1.0 / 1023));
}

TEST_CASE("a regular grid in all bits has the pattern of fewer bits and is not taken for one of these")
{
    for (const int divisions : { 5, 15, 12 }) {
        CAPTURE(divisions);
        GlbBuilder glb;
        std::vector<std::int16_t> line;
        for (int k = -divisions; k <= divisions; ++k)
            for (const int c : { k, 1 - std::abs(k) % 2, 0 })
                line.push_back(static_cast<std::int16_t>(std::lround(32767.0 * c / divisions)));
        Json primitive = { { "attributes", { { "POSITION", glb.add(line, 5122, 3, "VEC3") } } } };
        glb.json["accessors"].back()["normalized"] = true;
        primitive["indices"] = glb.add(std::vector<std::uint32_t> { 0, 1, 2 }, 5125, 1, "SCALAR");
        primitive["targets"].push_back({ { "POSITION", glb.add(std::vector<float>(line.size(), 0.1f), 5126, 3, "VEC3") } });
        glb.json["meshes"].push_back({ { "primitives", Json::array({ primitive }) } });
        glb.json["nodes"].push_back({ { "mesh", 0 } });
        glb.json["scenes"][0]["nodes"] = { 0 };
        const pliant_test::TemporaryFolder folder;
        pliant_test::write_bytes(folder / "line.glb", glb.glb());
        DiagnosticList diagnostics;
        const std::vector<MeshFile> read = read_pose_sources({ folder / "line.glb" }, Blend::layers, diagnostics).meshes;
        REQUIRE(read.size() == 2);
        CHECK(read[0].position_steps == std::vector<double> { 1.0 / 32767 });
    }
}

TEST_CASE("seams join the nearest vertices of other parts, never two of one part, and only borders")
{
    // Two strips side by side; the third vertex of the second one lies near two of the first.
    Positions p(8, 3);
    p << 0, 0, 0, 1, 0, 0, 1.4, 0, 0, 0, 1, 0, 0.2, 0, 0, 1.1, 0, 0, 1.3, 0, 0, 0, -1, 0;
    const std::vector<Triangle> triangles = { { 0, 1, 3 }, { 1, 2, 3 }, { 4, 7, 5 }, { 5, 7, 6 } };
    std::vector<std::uint32_t> targets = numbers_to(8);
    RoundedParts parts = alike({ 0, 0, 0, 0, 1, 1, 1, 1 }, 0.35);
    CHECK(weld_seams({ &p }, triangles, parts, targets) == 3);
    CHECK(targets == std::vector<std::uint32_t> { 0, 1, 2, 3, 0, 1, 2, 7 });
    // Faces that are drawn from both sides or have no area do not hide a border.
    std::vector<Triangle> twice = triangles;
    twice.insert(twice.end(), { { 0, 3, 1 }, { 1, 3, 2 }, { 5, 4, 7 }, { 5, 6, 5 } });
    targets = numbers_to(8);
    CHECK(weld_seams({ &p }, twice, parts, targets) == 3);
    // The ends of the seam coincide already.
    targets = { 0, 1, 2, 3, 0, 5, 2, 7 };
    CHECK(weld_seams({ &p }, triangles, parts, targets) == 1);
    CHECK(targets == std::vector<std::uint32_t> { 0, 1, 2, 3, 0, 1, 2, 7 });
    // The finest part knows best where the seam is.
    parts.reaches << 0.3, 0.05;
    targets = numbers_to(8);
    CHECK(weld_seams({ &p }, triangles, parts, targets) == 3);
    CHECK(targets == std::vector<std::uint32_t> { 4, 5, 6, 3, 4, 5, 6, 7 });
    // A seam is joined whole or not at all: rounding moves one of the parts too far.
    parts.reaches << 0.3, 0;
    targets = numbers_to(8);
    CHECK(weld_seams({ &p }, triangles, parts, targets) == 0);
    // Near in one pose only.
    Positions moved = p;
    moved.row(4) << 0.2, 0.5, 0;
    targets = numbers_to(8);
    CHECK(weld_seams({ &p, &moved }, triangles, alike(parts.of_vertex, 0.35, 2), targets) == 2);
    CHECK(targets[4] == 4);
    // The back of a sheet is cut along the other diagonal, and the rounded quad is not quite flat.
    Positions sheet = p;
    sheet.row(1) << 1, -0.1, 0.02;
    targets = numbers_to(8);
    const std::vector<Triangle> backed = { { 0, 1, 3 }, { 1, 2, 3 }, { 0, 2, 1 }, { 0, 3, 2 }, { 4, 7, 5 }, { 5, 7, 6 } };
    CHECK(weld_seams({ &sheet }, backed, alike(parts.of_vertex, 0.35), targets) == 3);
    // A solid has no border.
    Positions solid(9, 3);
    solid << p, 0.5, 0.5, 1;
    const std::vector<Triangle> closed
        = { { 0, 1, 3 }, { 1, 2, 3 }, { 0, 8, 1 }, { 1, 8, 2 }, { 0, 3, 8 }, { 2, 8, 3 }, { 4, 7, 5 }, { 5, 7, 6 } };
    targets = numbers_to(9);
    CHECK(weld_seams({ &solid }, closed, alike({ 0, 0, 0, 0, 1, 1, 1, 1, 0 }, 0.35), targets) == 0);
}

TEST_CASE("parts that are near each other and no one body stay apart")
{
    // A stack of triangles: each near the next one, the first and the last apart.
    Positions stack(12, 3);
    std::vector<Triangle> sheets;
    std::vector<std::uint32_t> of_vertex;
    for (std::uint32_t v = 0; v < 12; ++v) {
        stack.row(v) << v % 3 / 2, v % 3 % 2, 0.01 * (v / 3);
        of_vertex.push_back(v / 3);
        if (v % 3 == 0) sheets.push_back({ v, v + 1, v + 2 });
    }
    std::vector<std::uint32_t> targets = numbers_to(12);
    CHECK(weld_seams({ &stack }, sheets, alike(of_vertex, 0.025), targets) == 6);
    for (const std::uint32_t v : numbers_to(12)) CHECK(stack(v, 2) - stack(targets[v], 2) < 0.025);
    // Layers at the distance that rounding reaches at most.
    targets = numbers_to(12);
    CHECK(weld_seams({ &stack }, sheets, alike(of_vertex, 0.011), targets) == 0);
    CHECK(targets == numbers_to(12));
    // Fine layers between coarse ones.
    RoundedParts mixed = alike(of_vertex, 0.04);
    mixed.reaches.middleRows(1, 2).setConstant(1e-4);
    CHECK(weld_seams({ &stack }, { sheets[1], sheets[2] }, mixed, targets) == 0);
    // Corners that touch, and no edge.
    stack.row(3) << 0, 0, 0.01;
    stack.row(4) << -1, 0, 0.01;
    stack.row(5) << 0, -1, 0.01;
    CHECK(weld_seams({ &stack }, { sheets[0], sheets[1] }, alike(of_vertex, 0.025), targets) == 0);
}

TEST_CASE("vertices beside each other in one part are nearer than their copies in the other one")
{
    constexpr std::uint32_t n = 40;
    Positions p(4 * n, 3);
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> of_vertex;
    for (std::uint32_t v = 0; v < 4 * n; ++v) {
        const std::uint32_t row = v / n;
        p.row(v) << 0.01 * (v % n), row < 2 ? row : 0.02 - (row - 2), 0;
        of_vertex.push_back(row / 2);
        if (row % 2 == 0 && v % n + 1 < n) {
            triangles.push_back({ v, v + 1, v + n });
            triangles.push_back({ v + 1, v + n + 1, v + n });
        }
    }
    std::vector<std::uint32_t> targets = numbers_to(4 * n);
    CHECK(weld_seams({ &p }, triangles, alike(of_vertex, 0.03), targets) == n);
    for (std::uint32_t v = 0; v < n; ++v) CHECK(targets[2 * n + v] == v);
}

namespace {

// Seconds of processor for that many border vertices, all of them within each other's reach.
double seconds_of_crowd(std::uint32_t n)
{
    Positions p(n, 3);
    p.setRandom();
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> of_vertex, targets = numbers_to(n);
    for (std::uint32_t v = 0; v < n; ++v) {
        of_vertex.push_back(v / (n / 2));
        if (v % 3 == 0) triangles.push_back({ v, v + 1, v + 2 });
    }
    const std::clock_t start = std::clock();
    weld_seams({ &p, &p, &p, &p }, triangles, alike(of_vertex, 4, 4), targets);
    return double(std::clock() - start) / CLOCKS_PER_SEC;
}

} // namespace

TEST_CASE("vertices that crowd within a reach take linear time")
{
    CHECK(seconds_of_crowd(12000) < 8 * seconds_of_crowd(3000)); // 4 times; without a limit 16 times or more
}
