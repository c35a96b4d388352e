#include "input/gltf/scene_chunk.h"

#include "input/gltf/accessor.h"
#include "input/gltf/read_render_scene.h"
#include "input/io/source_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <utility>

namespace pliant {
namespace {

constexpr std::uint32_t json_tag = 0x4e4f534a, binary_tag = 0x004e4942;

// The JSON and the one buffer of a binary glTF file while it grows.
struct Glb {
    GltfJson json = { { "asset", { { "version", "2.0" }, { "generator", "pliant" } } } };
    std::string bytes;

    template <class T> void put(T value)
    {
        const char* p = reinterpret_cast<const char*>(&value); // the baker runs on little-endian machines; glTF is
        bytes.append(p, sizeof value);
    }
    std::size_t add_view(std::size_t start)
    {
        json["bufferViews"].push_back({ { "buffer", 0 }, { "byteOffset", start }, { "byteLength", bytes.size() - start } });
        bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
        return json["bufferViews"].size() - 1;
    }
    std::size_t add_accessor(GltfJson accessor)
    {
        json["accessors"].push_back(std::move(accessor));
        return json["accessors"].size() - 1;
    }
};

std::size_t add_indices(Glb& glb, const RenderScene& scene, const ScenePart& part)
{
    const std::size_t start = glb.bytes.size();
    const bool is_short = part.vertex_count < 65535; // 65535 itself means "restart" to an engine
    for (std::uint32_t f = part.first_face; f < part.first_face + part.face_count; ++f) {
        for (const std::uint32_t corner : scene.triangles[f]) {
            if (is_short)
                glb.put(static_cast<std::uint16_t>(corner - part.first_vertex));
            else
                glb.put(corner - part.first_vertex);
        }
    }
    return glb.add_accessor({ { "bufferView", glb.add_view(start) },
                              { "componentType", is_short ? gltf_uint16 : gltf_uint32 },
                              { "count", 3 * part.face_count },
                              { "type", "SCALAR" } });
}

// Four bytes a vertex fewer than floats, and 0.002 degrees.
std::size_t add_normals(Glb& glb, const VertexAttribute& normals, const ScenePart& part)
{
    const std::size_t start = glb.bytes.size();
    for (std::size_t v = part.first_vertex; v < part.first_vertex + std::size_t(part.vertex_count); ++v) {
        for (std::size_t c = 0; c < 3; ++c)
            glb.put(static_cast<std::int16_t>(std::lround(32767 * std::clamp(normals.values[3 * v + c], -1.0f, 1.0f))));
        glb.put(std::int16_t(0));
    }
    const std::size_t view = glb.add_view(start);
    glb.json["bufferViews"][view]["byteStride"] = 8;
    return glb.add_accessor({ { "bufferView", view },
                              { "componentType", gltf_int16 },
                              { "normalized", true },
                              { "count", part.vertex_count },
                              { "type", "VEC3" } });
}

std::size_t add_floats(Glb& glb, const VertexAttribute& attribute, const ScenePart& part)
{
    const std::size_t start = glb.bytes.size(), width = attribute.components;
    const std::size_t first = part.first_vertex * width;
    for (std::size_t i = first; i < first + part.vertex_count * width; ++i) glb.put(attribute.values[i]);
    return glb.add_accessor({ { "bufferView", glb.add_view(start) },
                              { "componentType", gltf_float32 },
                              { "count", part.vertex_count },
                              { "type", fmt::format("VEC{}", width) } });
}

GltfJson encode_part(Glb& glb, const RenderScene& scene, const ScenePart& part)
{
    GltfJson primitive
        = { { "attributes", GltfJson::object() },
            { "extras",
              { { "name", part.name }, { "first_vertex", part.first_vertex }, { "vertex_count", part.vertex_count } } } };
    if (part.face_count != 0) primitive["indices"] = add_indices(glb, scene, part);
    if (part.material >= 0) primitive["material"] = part.material;
    for (const std::string& name : part.attributes) {
        const VertexAttribute& attribute = *scene.find(name);
        if (part.vertex_count == 0) continue;
        primitive["attributes"][name]
            = name == "NORMAL" ? add_normals(glb, attribute, part) : add_floats(glb, attribute, part);
    }
    return primitive;
}

void append(std::vector<std::uint8_t>& out, std::uint32_t value)
{
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

// Binary glTF, its two parts padded to multiples of four.
std::vector<std::uint8_t> join(std::string text, const std::string& bytes)
{
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t size = 28 + std::uint64_t(text.size()) + bytes.size();
    if (size > UINT32_MAX)
        throw Failure(ExitCode::bad_input,
                      error_at(2330, "", fmt::format("the scene would take {} bytes, the limit is 4294967295", size),
                               "leave it out with --no-scene, or make its images smaller"));
    std::vector<std::uint8_t> out = { 'g', 'l', 'T', 'F' };
    append(out, 2);
    append(out, static_cast<std::uint32_t>(size));
    append(out, static_cast<std::uint32_t>(text.size()));
    append(out, json_tag);
    out.insert(out.end(), text.begin(), text.end());
    append(out, static_cast<std::uint32_t>(bytes.size()));
    append(out, binary_tag);
    out.insert(out.end(), bytes.begin(), bytes.end());
    return out;
}

// Numbers of one part, at its rows.
void decode_attribute(const GltfDocument& document, const GltfValue& value, const std::string& name, const ScenePart& part,
                      GltfAllowance& allowance, RenderScene& scene)
{
    allowance.take_all_of(value);
    const GltfNumbers numbers = read_numbers(document, value, { 2, 3, 4 }, part.vertex_count);
    const std::uint32_t width = static_cast<std::uint32_t>(numbers.cols());
    const auto is_it = [&](const VertexAttribute& attribute) { return attribute.name == name; };
    if (std::none_of(scene.attributes.begin(), scene.attributes.end(), is_it))
        scene.attributes.push_back({ name, width, std::vector<float>(std::size_t(scene.vertex_count) * width, 0.0f) });
    VertexAttribute& attribute = *std::find_if(scene.attributes.begin(), scene.attributes.end(), is_it);
    if (attribute.components != width)
        value.fail(2311, fmt::format("has {} numbers here, elsewhere {}", width, attribute.components));
    for (Eigen::Index i = 0; i < numbers.size(); ++i)
        attribute.values[part.first_vertex * std::size_t(width) + static_cast<std::size_t>(i)]
            = static_cast<float>(numbers.data()[i]);
}

void decode_faces(const GltfDocument& document, const GltfValue& primitive, ScenePart& part, GltfAllowance& allowance,
                  RenderScene& scene)
{
    part.first_face = static_cast<std::uint32_t>(scene.triangles.size());
    if (!primitive["indices"].exists()) return;
    allowance.take_all_of(primitive["indices"]);
    const std::vector<std::uint32_t> corners = read_indices(document, primitive["indices"], 1);
    if (corners.size() % 3 != 0) primitive["indices"].fail(2317, fmt::format("has {} corners of triangles", corners.size()));
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        for (std::size_t c = 0; c < 3; ++c)
            if (corners[i + c] >= part.vertex_count)
                primitive["indices"].fail(
                    2315, fmt::format("corner {} is vertex {}, there are {}", i + c, corners[i + c], part.vertex_count));
        const std::uint32_t first = part.first_vertex;
        scene.triangles.push_back({ first + corners[i], first + corners[i + 1], first + corners[i + 2] });
    }
    part.face_count = static_cast<std::uint32_t>(scene.triangles.size()) - part.first_face;
}

// Vertices of parts follow each other without gaps.
std::vector<ScenePart> decode_parts(const GltfDocument& document, const GltfValue& primitives, std::uint64_t limit)
{
    std::vector<ScenePart> parts;
    std::uint64_t vertex = 0;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const GltfValue primitive = primitives.at(i), extras = primitive["extras"];
        const std::uint64_t count = extras["vertex_count"].whole();
        if (extras["first_vertex"].whole() != vertex || count > limit - vertex)
            extras.fail(2317, fmt::format("vertex {} expected as the first, and at most {} in all", vertex, limit));
        ScenePart part;
        part.name = extras["name"].text_or("");
        part.material = primitive["material"].index_or_none(document["materials"].size(), "materials");
        part.first_vertex = static_cast<std::uint32_t>(vertex);
        part.vertex_count = static_cast<std::uint32_t>(count);
        vertex += count;
        parts.push_back(std::move(part));
    }
    return parts;
}

std::string take_materials(const GltfDocument& document, std::vector<std::string>& images)
{
    check_materials(document);
    GltfJson materials = GltfJson::object();
    for (const char* key : { "materials", "textures", "samplers" })
        if (document[key].size() != 0) materials[key] = document[key].json();
    const GltfValue list = document["images"];
    std::size_t left = document.byte_count(); // each has its own
    for (std::size_t i = 0; i < list.size(); ++i) {
        std::string why;
        images.push_back(document.image(i, why));
        if (images.back().empty()) list.at(i).fail(2308, "has no bytes in the asset");
        if (images.back().size() > left) list.at(i).fail(2308, "shares its bytes with other images");
        left -= images.back().size();
        GltfJson image = GltfJson::object(); // and no address, which whoever opens the export would ask
        for (const char* key : { "name", "mimeType" })
            if (list.at(i)[key].exists()) image[key] = list.at(i)[key].text();
        materials["images"].push_back(std::move(image));
    }
    list_extensions(document, materials);
    return materials.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
}

} // namespace

std::vector<std::uint8_t> encode_scene_chunk(const RenderScene& scene)
{
    Glb glb;
    glb.json.update(GltfJson::parse(scene.materials));
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        const std::size_t start = glb.bytes.size();
        glb.bytes += scene.images[i];
        glb.json["images"][i]["bufferView"] = glb.add_view(start);
    }
    GltfJson primitives = GltfJson::array();
    for (const ScenePart& part : scene.parts) primitives.push_back(encode_part(glb, scene, part));
    GltfJson mesh = GltfJson::object(), node = GltfJson::object(), root = GltfJson::object(), buffer = GltfJson::object();
    mesh["primitives"] = std::move(primitives);
    node["mesh"] = 0;
    root["nodes"] = GltfJson::array({ 0 });
    buffer["byteLength"] = glb.bytes.size();
    glb.json["meshes"].push_back(std::move(mesh));
    glb.json["nodes"].push_back(std::move(node));
    glb.json["scenes"].push_back(std::move(root));
    glb.json["scene"] = 0;
    glb.json["buffers"].push_back(std::move(buffer));
    if (scene.find("NORMAL")) {
        glb.json["extensionsUsed"].push_back("KHR_mesh_quantization");
        glb.json["extensionsRequired"].push_back("KHR_mesh_quantization");
    }
    return join(glb.json.dump(-1, ' ', false, GltfJson::error_handler_t::replace), glb.bytes);
}

RenderScene decode_scene_chunk(std::string_view bytes, const std::string& path, std::size_t vertex_limit)
{
    const GltfDocument document(path, std::string(bytes));
    const GltfValue primitives = document["meshes"].at(0)["primitives"];
    RenderScene scene;
    scene.path = path;
    scene.parts = decode_parts(document, primitives, vertex_limit);
    if (!scene.parts.empty()) scene.vertex_count = scene.parts.back().first_vertex + scene.parts.back().vertex_count;
    GltfAllowance allowance(document, 1000000, 2); // each number is stored once, in a byte or more
    for (std::size_t i = 0; i < scene.parts.size(); ++i) {
        ScenePart& part = scene.parts[i];
        decode_faces(document, primitives.at(i), part, allowance, scene);
        const GltfValue attributes = primitives.at(i)["attributes"];
        if (!attributes.exists() || !attributes.json().is_object()) attributes.fail(2306, "an object expected");
        for (const auto& item : attributes.json().items()) {
            if (!is_drawn_attribute(item.key())) continue;
            part.attributes.push_back(item.key());
            decode_attribute(document, attributes[item.key()], item.key(), part, allowance, scene);
        }
    }
    scene.materials = take_materials(document, scene.images);
    return scene;
}

} // namespace pliant
