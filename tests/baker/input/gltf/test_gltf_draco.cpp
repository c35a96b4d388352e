// Meshes compressed with Draco: vertices and triangles as Draco's own decoder gives them, in its order.
#include <doctest/doctest.h>

#include "../io/files.h"
#include "glb_samples.h"
#include "input/gltf/render_scene.h"
#include "input/poses/pose_source.h"
#include "skip.h"

#include <draco/compression/decode.h>

using namespace pliant;

namespace {

std::unique_ptr<draco::Mesh> decode(const std::string& data)
{
    draco::DecoderBuffer buffer;
    buffer.Init(data.data(), data.size());
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    return result.ok() ? std::move(result).value() : nullptr;
}

std::vector<MeshFile> read(const std::string& path, DiagnosticList& diagnostics)
{
    return read_pose_sources({ path, path }, Blend::layers, diagnostics).meshes;
}

// Positions of points in order, bit for bit; corners of faces in order, from vertex `first` and face `face` on.
bool is_same(const draco::Mesh& wanted, const MeshFile& mesh, Eigen::Index first = 0, std::size_t face = 0)
{
    const draco::PointAttribute* positions = wanted.GetNamedAttribute(draco::GeometryAttribute::POSITION);
    for (draco::PointIndex i(0); i < wanted.num_points(); ++i) {
        float p[3];
        positions->GetMappedValue(i, p);
        for (int c = 0; c < 3; ++c)
            if (mesh.positions(first + static_cast<Eigen::Index>(i.value()), c) != static_cast<double>(p[c])) return false;
    }
    for (draco::FaceIndex f(0); f < wanted.num_faces(); ++f)
        for (std::size_t c = 0; c < 3; ++c)
            if (mesh.faces.indices[3 * (face + f.value()) + c]
                != wanted.face(f)[c].value() + static_cast<std::uint32_t>(first))
                return false;
    return true;
}

// What is said first of a file.
Diagnostic refusal_of(const std::string& glb)
{
    const pliant_test::TemporaryFolder folder;
    pliant_test::write_bytes(folder / "a.glb", glb);
    DiagnosticList diagnostics;
    read(folder / "a.glb", diagnostics);
    REQUIRE(diagnostics.has_errors());
    return diagnostics.diagnostics().at(0);
}

} // namespace

TEST_CASE("sequential and edgebreaker data, in the decoder's order, with a morph target in that order")
{
    const pliant_test::TemporaryFolder folder;
    const std::size_t n = pliant_test::grid_positions().size() / 3;
    for (const int method : { draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING }) {
        CAPTURE(method);
        const std::string data = pliant_test::encode_draco(method);
        const std::unique_ptr<draco::Mesh> wanted = decode(data);
        REQUIRE(wanted);
        REQUIRE(wanted->num_points() == n);
        pliant_test::write_bytes(folder / "a.glb", pliant_test::draco_glb(data, n, n));
        DiagnosticList diagnostics;
        const std::vector<MeshFile> poses = read(folder / "a.glb", diagnostics);
        REQUIRE(poses.size() == 4);
        CHECK(is_same(*wanted, poses[0]));
        for (Eigen::Index v = 0; v < poses[0].positions.rows(); ++v)
            CHECK(poses[1].positions(v, 1) - poses[0].positions(v, 1) == doctest::Approx(3.0 * static_cast<double>(v) + 1));
        const VertexAttribute* places = poses[0].scene->find("TEXCOORD_0");
        REQUIRE(places);
        for (std::size_t v = 0; v < n; ++v) // x / 8, whatever the order
            CHECK(8 * places->values[2 * v]
                  == doctest::Approx(poses[0].positions(static_cast<Eigen::Index>(v), 0)).epsilon(2e-3));
    }
}

TEST_CASE("a morph target with another number of vertices than were decoded")
{
    const std::string data = pliant_test::encode_draco(draco::MESH_SEQUENTIAL_ENCODING);
    CHECK(refusal_of(pliant_test::draco_glb(data, 49, 48)).number == 2317);
}

TEST_CASE("an attribute that the data do not have, and one whose name wants elements of another width")
{
    const std::string good = pliant_test::draco_glb(pliant_test::encode_draco(draco::MESH_SEQUENTIAL_ENCODING), 49, 49);
    std::string glb = good;
    glb.replace(glb.rfind("\"TEXCOORD_0\":1}"), 15, "\"TEXCOORD_0\":9}");
    CHECK(refusal_of(glb).number == 2318);
    glb = good;
    const std::string places = "\"TEXCOORD_0\":", normals = "\"NORMAL\"    :";
    for (std::size_t at = 0; (at = glb.find(places, at)) != std::string::npos;) glb.replace(at, places.size(), normals);
    CHECK(refusal_of(glb).number == 2311);
}

TEST_CASE("data that many primitives share are decoded for each, within a limit of their bytes")
{
    const std::string data = pliant_test::encode_draco(draco::MESH_SEQUENTIAL_ENCODING) + std::string(100000, '\0');
    const Diagnostic refusal = refusal_of(pliant_test::draco_glb(data, 49, 49, 100));
    CHECK(refusal.number == 2333);
    CHECK(refusal.what.find("KHR_draco_mesh_compression") != std::string::npos);
}

TEST_CASE("as many faces as a stream says it has are not believed")
{
    const std::string head { "DRACO\2\2\1\1\0\0\0", 12 }, faces = "\x80\x84\xaf\x5f", vertices = "\xa0\x8d\6"; // 2e8, 1e5
    const Diagnostic refusal
        = refusal_of(pliant_test::draco_glb(head + vertices + faces + '\0' + faces + std::string(64, '\0'), 49, 49));
    CHECK(refusal.number == 2333);
    CHECK(refusal.what.find("200000000 x 3") != std::string::npos);
}

// A sequential stream: 30,000 faces of 90,000 vertices with five attributes of 255 numbers, all of them zeros by one symbol.
TEST_CASE("as many attributes as a stream says it has are not believed")
{
    const std::string faces = "\xb0\xea\1", vertices = "\x90\xbf\5";
    const std::string zeros { "\1\1\1\1\x40\2\0\x40", 8 }; // a table of one symbol, and no bits
    std::string data = std::string("DRACO\2\2\1\0\0\0", 11) + faces + vertices + '\0' + zeros + "\1\5";
    for (int a = 0; a < 5; ++a) {
        const char head[] { char(a == 0 ? 0 : 4), draco::DT_INT8, char(255), 0, char(a) };
        data.append(head, sizeof head);
    }
    data += "\1\1\1\1\1";
    for (int a = 0; a < 5; ++a) data += "\xfe\1" + zeros; // no prediction
    data += std::string(100000, '\0');
    const Diagnostic refusal = refusal_of(pliant_test::draco_glb(data, 49, 49));
    CHECK(refusal.number == 2333);
    CHECK(refusal.what.find("90000 x 1275") != std::string::npos);
}

TEST_CASE("real files of others' making")
{
    const std::string data = pliant_test::data_folder();
    if (data.empty()) PLIANT_SKIP("no data: set PLIANT_DATA");
    for (const char* name : { "AnimatedMorphSphere_draco", "CesiumMan_draco", "Enemy_Small-transformed",
                              "MorphStressTest_draco", "Mech_FinnTheFrog-transformed", "ict_face_14targets_draco" }) {
        CAPTURE(name);
        const std::string path = data + "/gltf_draco/" + name + ".glb", bytes = pliant_test::read_bytes(path);
        std::uint32_t json_size = 0;
        std::memcpy(&json_size, bytes.data() + 12, 4);
        pliant_test::Json json = pliant_test::Json::parse(bytes.substr(20, json_size));
        // The mesh alone, at the origin, so that positions are those of the decoder bit for bit.
        for (auto& node : json["nodes"])
            for (const char* key : { "translation", "rotation", "scale", "matrix", "skin" }) node.erase(key);
        std::string text = json.dump();
        text.resize(json_size, ' ');
        const pliant_test::TemporaryFolder folder;
        pliant_test::write_bytes(folder / "a.glb", bytes.substr(0, 20) + text + bytes.substr(20 + json_size));
        DiagnosticList diagnostics;
        const std::vector<MeshFile> poses = read(folder / "a.glb", diagnostics);
        REQUIRE(poses.size() >= 2);
        Eigen::Index first = 0;
        std::size_t face = 0;
        for (const auto& mesh : json["meshes"])
            for (const auto& primitive : mesh["primitives"]) {
                const auto& view
                    = json["bufferViews"]
                          [primitive["extensions"]["KHR_draco_mesh_compression"]["bufferView"].get<std::size_t>()];
                const std::unique_ptr<draco::Mesh> wanted
                    = decode(bytes.substr(28 + json_size + view.value("byteOffset", std::size_t(0)), view["byteLength"]));
                REQUIRE(wanted);
                CHECK(is_same(*wanted, poses[0], first, face));
                first += wanted->num_points();
                face += wanted->num_faces();
            }
        CHECK(first == poses[0].positions.rows());
        CHECK(face == poses[0].faces.count());
    }
}
