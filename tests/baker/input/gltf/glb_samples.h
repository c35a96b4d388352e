// Small glTF files made in memory: with everything that moves, and with Draco data made by Draco's own encoder.
#pragma once

#include <cmath>
#include <cstdint>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pliant_test {

using Json = nlohmann::json;

// JSON and buffer of a .glb while it grows.
struct GlbBuilder {
    Json json = Json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}]})");
    Json more_buffers = Json::array(); // without bytes, behind that of the bytes
    std::string bytes;

    int add_view(const std::string& data)
    {
        bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
        Json view = Json::object();
        view["buffer"] = 0;
        view["byteOffset"] = bytes.size();
        view["byteLength"] = data.size();
        bytes += data;
        json["bufferViews"].push_back(std::move(view));
        return static_cast<int>(json["bufferViews"].size()) - 1;
    }
    // `view` -1: none, the numbers come from elsewhere.
    int add_accessor(int view, int component_type, std::size_t count, const char* type)
    {
        Json accessor = Json::object();
        if (view >= 0) accessor["bufferView"] = view;
        accessor["componentType"] = component_type;
        accessor["count"] = count;
        accessor["type"] = type;
        json["accessors"].push_back(std::move(accessor));
        return static_cast<int>(json["accessors"].size()) - 1;
    }
    template <class T> int add(const std::vector<T>& values, int component_type, std::size_t width, const char* type)
    {
        const std::string data(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        return add_accessor(add_view(data), component_type, values.size() / width, type);
    }
    std::string glb()
    {
        bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
        json["buffers"] = Json::array();
        json["buffers"].push_back({ { "byteLength", bytes.size() } });
        for (const Json& other : more_buffers) json["buffers"].push_back(other);
        std::string text = json.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string out = "glTF";
        const auto put = [&](std::size_t value) {
            for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(value >> 8 * i));
        };
        put(2), put(28 + text.size() + bytes.size()), put(text.size()), put(0x4e4f534a);
        out += text;
        put(bytes.size()), put(0x004e4942);
        return out + bytes;
    }
};

constexpr std::uint32_t grid_size = 6; // squares along each side

inline std::vector<float> grid_positions()
{
    std::vector<float> out;
    for (std::uint32_t i = 0; i <= grid_size; ++i)
        for (std::uint32_t k = 0; k <= grid_size; ++k)
            out.insert(out.end(),
                       { static_cast<float>(i), static_cast<float>(k), 0.1f * static_cast<float>(i * i + 3 * k) });
    return out;
}

inline std::vector<std::uint32_t> grid_corners()
{
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < grid_size; ++i)
        for (std::uint32_t k = 0; k < grid_size; ++k) {
            const std::uint32_t a = i * (grid_size + 1) + k, b = a + grid_size + 1;
            out.insert(out.end(), { a, b, b + 1, a, b + 1, a + 1 });
        }
    return out;
}

// A skinned grid of one morph target, with an animation of bone and weight, a texture, and a sparse accessor.
inline std::string moving_glb()
{
    GlbBuilder glb;
    const std::vector<float> positions = grid_positions();
    const std::size_t n = positions.size() / 3;
    std::vector<std::uint8_t> joints(4 * n, 0);
    std::vector<float> weights(4 * n, 0.0f), moved(positions.size(), 0.0f), matrices(32, 0.0f);
    for (std::size_t v = 0; v < n; ++v)
        joints[4 * v + 1] = 1, weights[4 * v] = 0.25f, weights[4 * v + 1] = 0.75f, moved[3 * v + 2] = 1;
    for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t i = 0; i < 16; ++i) matrices[16 * j + i] = i % 5 == 0 ? 1.0f : 0.0f;
    Json primitive = Json::object();
    primitive["attributes"]["POSITION"] = glb.add(positions, 5126, 3, "VEC3");
    primitive["attributes"]["JOINTS_0"] = glb.add(joints, 5121, 4, "VEC4");
    primitive["attributes"]["WEIGHTS_0"] = glb.add(weights, 5126, 4, "VEC4");
    primitive["indices"] = glb.add(grid_corners(), 5125, 1, "SCALAR");
    Json target = Json::object();
    target["POSITION"] = glb.add(moved, 5126, 3, "VEC3");
    Json sparse = Json::object();
    sparse["count"] = 2;
    sparse["indices"] = { { "bufferView", glb.add_view(std::string("\x03\x07", 2)) }, { "componentType", 5121 } };
    sparse["values"] = { { "bufferView", glb.add_view(std::string(24, '\0')) } };
    glb.json["accessors"].back()["sparse"] = std::move(sparse);
    primitive["targets"].push_back(std::move(target));
    primitive["material"] = 0;
    Json mesh = Json::object();
    mesh["primitives"].push_back(std::move(primitive));
    glb.json["meshes"].push_back(std::move(mesh));
    glb.json.update(Json::parse(R"({"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
        "textures":[{"source":0}],
        "nodes":[{"mesh":0,"skin":0,"children":[1]},{"children":[2],"translation":[0,0,1]},{"scale":[1,2,1]}],
        "skins":[{"joints":[1,2]}],
        "animations":[{"name":"Run","channels":[{"sampler":0,"target":{"node":1,"path":"rotation"}},
        {"sampler":1,"target":{"node":0,"path":"weights"}}],"samplers":[{},{"interpolation":"CUBICSPLINE"}]}]})"));
    Json image = Json::object();
    image["bufferView"] = glb.add_view("\x89PNG");
    image["mimeType"] = "image/png";
    glb.json["images"].push_back(std::move(image));
    glb.json["skins"][0]["inverseBindMatrices"] = glb.add(matrices, 5126, 16, "MAT4");
    Json& samplers = glb.json["animations"][0]["samplers"];
    const int times = glb.add(std::vector<float> { 0, 1 }, 5126, 1, "SCALAR");
    samplers[0]["input"] = samplers[1]["input"] = times;
    samplers[0]["output"] = glb.add(std::vector<float> { 0, 0, 0, 1, 0, 0.6f, 0, 0.8f }, 5126, 4, "VEC4");
    samplers[1]["output"] = glb.add(std::vector<float> { 0, 0, 1, 1, 1, 0 }, 5126, 1, "SCALAR");
    return glb.glb();
}

inline int add_draco_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, int width,
                               const std::vector<float>& values)
{
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, static_cast<std::uint8_t>(width), draco::DT_FLOAT32, false, 4 * width, 0);
    const auto count = static_cast<std::uint32_t>(values.size()) / static_cast<std::uint32_t>(width);
    const int id = mesh.AddAttribute(attribute, true, count);
    for (std::uint32_t v = 0; v < count; ++v)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), &values[v * static_cast<std::uint32_t>(width)]);
    return id;
}

// Positions (attribute 0) and triangles.
inline std::unique_ptr<draco::Mesh> draco_mesh(const std::vector<float>& positions,
                                               const std::vector<std::uint32_t>& corners)
{
    auto mesh = std::make_unique<draco::Mesh>();
    mesh->set_num_points(static_cast<std::uint32_t>(positions.size()) / 3);
    mesh->SetNumFaces(corners.size() / 3);
    for (std::uint32_t f = 0; f < corners.size() / 3; ++f)
        mesh->SetFace(draco::FaceIndex(f),
                      { draco::PointIndex(corners[3 * f]), draco::PointIndex(corners[3 * f + 1]),
                        draco::PointIndex(corners[3 * f + 2]) });
    add_draco_attribute(*mesh, draco::GeometryAttribute::POSITION, 3, positions);
    return mesh;
}

// The grid with a texture coordinate per vertex. `method`: MESH_SEQUENTIAL_ENCODING or MESH_EDGEBREAKER_ENCODING.
inline std::string encode_draco(int method)
{
    const std::vector<float> positions = grid_positions();
    const std::unique_ptr<draco::Mesh> mesh = draco_mesh(positions, grid_corners());
    std::vector<float> places;
    for (std::size_t v = 0; v < positions.size(); v += 3)
        places.insert(places.end(), { positions[v] / 8, positions[v + 1] / 8 });
    add_draco_attribute(*mesh, draco::GeometryAttribute::TEX_COORD, 2, places);
    draco::ExpertEncoder encoder(*mesh);
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(0, 14);
    encoder.SetAttributeQuantization(1, 12);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeToBuffer(&buffer).ok()) return {};
    return { buffer.data(), buffer.size() };
}

// Around Draco data with attributes 0 (positions) and 1 (texture coordinates); one morph target of as many vertices, plain.
inline std::string draco_glb(const std::string& data, std::size_t vertex_count, std::size_t target_count,
                             std::size_t primitive_count = 1)
{
    GlbBuilder glb;
    Json primitive = Json::object();
    primitive["attributes"]["POSITION"] = glb.add_accessor(-1, 5126, vertex_count, "VEC3");
    primitive["attributes"]["TEXCOORD_0"] = glb.add_accessor(-1, 5126, vertex_count, "VEC2");
    primitive["indices"] = glb.add_accessor(-1, 5125, grid_corners().size(), "SCALAR");
    Json extension = Json::parse(R"({"attributes":{"POSITION":0,"TEXCOORD_0":1}})");
    extension["bufferView"] = glb.add_view(data);
    primitive["extensions"]["KHR_draco_mesh_compression"] = std::move(extension);
    std::vector<float> moved(3 * target_count);
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = static_cast<float>(i);
    Json target = Json::object();
    target["POSITION"] = glb.add(moved, 5126, 3, "VEC3");
    primitive["targets"].push_back(std::move(target));
    Json mesh = Json::object();
    for (std::size_t i = 0; i < primitive_count; ++i) mesh["primitives"].push_back(primitive);
    glb.json["meshes"].push_back(std::move(mesh));
    glb.json["extensionsRequired"].push_back("KHR_draco_mesh_compression");
    return glb.glb();
}

} // namespace pliant_test
