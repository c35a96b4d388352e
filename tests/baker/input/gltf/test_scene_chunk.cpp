// The scene chunk: what it holds comes back, and damaged bytes are refused.
#include <doctest/doctest.h>

#include "../io/files.h"
#include "glb_samples.h"
#include "input/gltf/scene_chunk.h"
#include "input/poses/pose_source.h"

#include <nlohmann/json.hpp>
#include <random>

using namespace pliant;

namespace {

// Two parts; only the first has colours, only the second a texture and an image.
RenderScene sample()
{
    RenderScene scene;
    scene.path = "sample";
    scene.vertex_count = 7;
    scene.triangles = { { 0, 1, 2 }, { 2, 1, 3 }, { 4, 5, 6 } };
    scene.parts
        = { { "body", 0, 0, 4, 0, 2, { "COLOR_0", "NORMAL" } }, { "eyes", 1, 4, 3, 2, 1, { "NORMAL", "TEXCOORD_0" } } };
    VertexAttribute colours { "COLOR_0", 4, std::vector<float>(28, 0.0f) },
        normals { "NORMAL", 3, std::vector<float>(21, 0.0f) }, places { "TEXCOORD_0", 2, std::vector<float>(14, 0.0f) };
    for (std::size_t i = 0; i < 16; ++i) colours.values[i] = 0.05f * static_cast<float>(i);
    for (std::size_t v = 0; v < 7; ++v) normals.values[3 * v + v % 3] = v % 2 == 0 ? 1.0f : -1.0f;
    for (std::size_t i = 8; i < 14; ++i) places.values[i] = 1.25f * static_cast<float>(i) - 3.0f;
    scene.attributes = { colours, normals, places };
    scene.materials = R"({"extensionsRequired":["KHR_texture_basisu"],)"
                      R"("extensionsUsed":["KHR_materials_unlit","KHR_texture_basisu"],)"
                      R"("images":[{"mimeType":"image/ktx2","name":"skin"}],)"
                      R"("materials":[{"name":"a","extensions":{"KHR_materials_unlit":{}}},{"name":"b"}],)"
                      R"("textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}]})";
    scene.images = { std::string("\x89PNG\0bytes", 10) };
    return scene;
}

std::string bytes_of(const RenderScene& scene)
{
    const std::vector<std::uint8_t> bytes = encode_scene_chunk(scene);
    return { bytes.begin(), bytes.end() };
}

} // namespace

TEST_CASE("a scene comes back from its chunk")
{
    const RenderScene before = sample(), after = decode_scene_chunk(bytes_of(before), "asset", 100);
    CHECK(after.vertex_count == 7);
    CHECK(after.triangles == before.triangles);
    CHECK(after.images == before.images);
    CHECK(nlohmann::json::parse(after.materials) == nlohmann::json::parse(before.materials));
    REQUIRE(after.parts.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(after.parts[i].name == before.parts[i].name);
        CHECK(after.parts[i].material == before.parts[i].material);
        CHECK(after.parts[i].first_vertex == before.parts[i].first_vertex);
        CHECK(after.parts[i].vertex_count == before.parts[i].vertex_count);
        CHECK(after.parts[i].first_face == before.parts[i].first_face);
        CHECK(after.parts[i].face_count == before.parts[i].face_count);
        CHECK(after.parts[i].attributes == before.parts[i].attributes);
    }
    for (const VertexAttribute& attribute : before.attributes) {
        CAPTURE(attribute.name);
        const VertexAttribute* read = after.find(attribute.name);
        REQUIRE(read);
        REQUIRE(read->values.size() == attribute.values.size());
        for (std::size_t i = 0; i < attribute.values.size(); ++i)
            CHECK(read->values[i] == doctest::Approx(attribute.values[i]).epsilon(3e-5));
    }
}

TEST_CASE("the same scene gives the same bytes, a multiple of four")
{
    CHECK(bytes_of(sample()) == bytes_of(sample()));
    CHECK(bytes_of(sample()).size() % 4 == 0);
}

TEST_CASE("a scene without attributes, materials or images")
{
    RenderScene scene = sample();
    scene.attributes.clear();
    scene.images.clear();
    scene.materials = "{}";
    for (ScenePart& part : scene.parts) part.attributes.clear(), part.material = -1;
    const RenderScene after = decode_scene_chunk(bytes_of(scene), "asset", 100);
    CHECK(after.vertex_count == 7);
    CHECK(after.triangles == scene.triangles);
    CHECK(after.attributes.empty());
}

TEST_CASE("no other file is opened")
{
    std::string bytes = bytes_of(sample());
    const std::size_t place = bytes.find("\"bufferView\":0,\"mimeType\"");
    REQUIRE(place != std::string::npos);
    bytes.replace(place, 14, "\"uri\":\"//etc\" "); // as long as what it replaces
    CHECK_THROWS_AS(decode_scene_chunk(bytes, "asset", 100), Failure);
}

TEST_CASE("only names and types of images come out of a chunk, and materials name textures that are there")
{
    std::string bytes = bytes_of(sample());
    const std::size_t place = bytes.find("\"mimeType\":");
    REQUIRE(place != std::string::npos);
    bytes.replace(place, 10, "\"uri12345\""); // as long as what it replaces
    CHECK(decode_scene_chunk(bytes, "asset", 100).materials.find("uri12345") == std::string::npos);
    RenderScene scene = sample();
    const std::string name = "{\"name\":\"b\"";
    scene.materials.insert(scene.materials.find(name) + name.size(), ",\"emissiveTexture\":{\"index\":7}");
    CHECK_THROWS_AS(decode_scene_chunk(bytes_of(scene), "asset", 100), Failure);
}

TEST_CASE("an image has the type that its bytes have, whatever the file says")
{
    pliant_test::GlbBuilder glb;
    pliant_test::Json primitive = pliant_test::Json::object(), mesh = pliant_test::Json::object();
    primitive["attributes"]["POSITION"] = glb.add(pliant_test::grid_positions(), 5126, 3, "VEC3");
    primitive["indices"] = glb.add(pliant_test::grid_corners(), 5125, 1, "SCALAR");
    mesh["primitives"].push_back(primitive);
    glb.json["meshes"].push_back(mesh);
    for (const char* bytes : { "\x89PNG\r\n\x1a\n", "\xff\xd8\xff", "\xabKTX 20\xbb", "DDS ", "RIFFsizeWEBP" })
        glb.json["images"].push_back({ { "bufferView", glb.add_view(bytes) }, { "mimeType", "image/png" } });
    glb.json["images"][4].erase("mimeType");
    const pliant_test::TemporaryFolder folder;
    pliant_test::write_bytes(folder / "images.glb", glb.glb());
    DiagnosticList diagnostics;
    const std::string file = folder / "images.glb";
    const std::vector<MeshFile> read = read_pose_sources({ file, file }, Blend::average, diagnostics).meshes;
    REQUIRE(read.size() == 2);
    const auto materials = nlohmann::json::parse(read[0].scene->materials);
    std::string types;
    for (const auto& image : materials["images"]) types += image["mimeType"].get<std::string>() + " ";
    CHECK(types == "image/png image/jpeg image/ktx2 image/vnd-ms.dds image/webp ");
}

TEST_CASE("damaged chunks are refused or read, never worse")
{
    const std::string good = bytes_of(sample());
    for (unsigned i = 0; i < 3000; ++i) {
        std::mt19937 random(i);
        const auto any = [&](std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random); };
        std::string bytes = good;
        for (std::size_t k = 0, count = 1 + any(4); k < count; ++k) bytes[any(bytes.size())] = static_cast<char>(any(256));
        try {
            const RenderScene scene = decode_scene_chunk(bytes, "asset", 100);
            for (const auto& triangle : scene.triangles)
                for (const std::uint32_t v : triangle) REQUIRE(v < scene.vertex_count);
        } catch (const Failure& failure) {
            REQUIRE(failure.code() == ExitCode::bad_input);
        }
    }
}
