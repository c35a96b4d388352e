#include "input/gltf/read_render_scene.h"

#include "input/gltf/evaluate.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace pliant {
namespace {

// The attribute of that name, made if need be.
VertexAttribute& attribute_of(RenderScene& scene, const std::string& name, std::uint32_t components)
{
    for (VertexAttribute& attribute : scene.attributes) {
        if (attribute.name != name) continue;
        if (attribute.components < components) { // colours with alpha in a later part
            std::vector<float> values(std::size_t(scene.vertex_count) * components, 0.0f);
            for (std::size_t v = 0; v < scene.vertex_count; ++v) {
                for (std::size_t c = 0; c < attribute.components; ++c)
                    values[v * components + c] = attribute.values[v * attribute.components + c];
                values[v * components + components - 1] = 1;
            }
            attribute.values = std::move(values);
            attribute.components = components;
        }
        return attribute;
    }
    scene.attributes.push_back({ name, components, std::vector<float>(std::size_t(scene.vertex_count) * components, 0.0f) });
    return scene.attributes.back();
}

void put_attribute(RenderScene& scene, const std::string& name, const GltfNumbers& numbers, std::uint32_t first)
{
    VertexAttribute& attribute = attribute_of(scene, name, static_cast<std::uint32_t>(numbers.cols()));
    for (Eigen::Index v = 0; v < numbers.rows(); ++v)
        for (std::uint32_t c = 0; c < attribute.components; ++c)
            attribute.values[(first + std::size_t(v)) * attribute.components + c]
                = static_cast<Eigen::Index>(c) < numbers.cols() ? static_cast<float>(numbers(v, c)) : 1.0f;
}

void put_parts(const GltfScene& scene, const Positions& normals, RenderScene& out)
{
    std::uint32_t vertex = 0, face = 0;
    for (const GltfInstance& instance : scene.instances) {
        const GltfMesh& mesh = scene.meshes[instance.mesh];
        for (const GltfPrimitive& primitive : mesh.primitives) {
            ScenePart part { mesh.name, primitive.material,
                             vertex,    static_cast<std::uint32_t>(primitive.vertex_count()),
                             face,      static_cast<std::uint32_t>(primitive.triangles.size()),
                             {} };
            for (const auto& [name, numbers] : primitive.attributes) {
                part.attributes.push_back(name);
                put_attribute(out, name,
                              name == "NORMAL" ? GltfNumbers(normals.middleRows(vertex, part.vertex_count)) : numbers,
                              vertex);
            }
            vertex += part.vertex_count;
            face += part.face_count;
            out.parts.push_back(std::move(part));
        }
    }
}

// The type of an image, by its first bytes; null if it is none: a uri may name any file beside the glTF file, which is not
// for everybody who gets the asset.
const char* image_type(const std::string& bytes)
{
    const auto begins = [&](std::string_view mark) { return bytes.compare(0, mark.size(), mark) == 0; };
    if (begins("\x89PNG\r\n\x1a\n")) return "image/png";
    if (begins("\xff\xd8\xff")) return "image/jpeg";
    if (begins("\xabKTX 20\xbb")) return "image/ktx2";
    if (begins("DDS ")) return "image/vnd-ms.dds";
    return begins("RIFF") && bytes.compare(8, 4, "WEBP") == 0 ? "image/webp" : nullptr;
}

// Images without their places in the file; their bytes go to `out`. numbers[i]: the new number of image i, -1 if it is left
// out.
GltfJson take_images(const GltfDocument& document, RenderScene& out, std::vector<int>& numbers,
                     std::vector<Diagnostic>& warnings)
{
    GltfJson images = GltfJson::array();
    const GltfValue list = document["images"];
    std::map<std::string, int> known;         // an image may stand in the list many times
    std::size_t left = document.byte_count(); // of views, which may overlap
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string source = document.image_source(i);
        if (const auto found = known.find(source); found != known.end()) {
            document.note_image(i);
            numbers.push_back(found->second);
            continue;
        }
        std::string why = "it is empty";
        std::string bytes = document.image(i, why);
        const bool is_view = source.compare(0, 5, "view ") == 0;
        if (!bytes.empty() && !image_type(bytes)) {
            why = "it is none of PNG, JPEG, WebP, KTX2 and DDS";
            bytes.clear();
        } else if (is_view && bytes.size() > left) {
            why = "it shares its bytes with other images";
            bytes.clear();
        }
        if (is_view) left -= bytes.size();
        numbers.push_back(bytes.empty() ? -1 : static_cast<int>(images.size()));
        if (!source.empty()) known[source] = numbers.back();
        if (bytes.empty()) {
            warnings.push_back(warning_at(2328, document.path(), fmt::format("image {} is left out: {}", i, why),
                                          "put the file there, or pack everything into one .glb"));
            continue;
        }
        GltfJson image = { { "mimeType", image_type(bytes) } };
        if (list.at(i)["name"].exists()) image["name"] = list.at(i)["name"].text();
        out.images.push_back(std::move(bytes));
        images.push_back(std::move(image));
    }
    return images;
}

// The element of `numbers` that a whole number selects, also one written as 1.0; -1: there is none.
int number_at(const GltfJson& place, const std::vector<int>& numbers)
{
    if (!place.is_number()) return -1;
    const double index = place.get<double>();
    return index >= 0 && index < double(numbers.size()) && index == std::floor(index) ? numbers[std::size_t(index)] : -1;
}

// An object with an image's number: the texture itself, or an extension's part of it.
void renumber_source(GltfJson& holder, const std::vector<int>& numbers)
{
    if (!holder.is_object() || !holder.contains("source")) return;
    const int number = number_at(holder["source"], numbers);
    if (number < 0)
        holder.erase("source");
    else
        holder["source"] = number;
}

GltfJson textures_of(const GltfDocument& document, const std::vector<int>& numbers)
{
    GltfJson textures = document["textures"].json();
    for (GltfJson& texture : textures) {
        renumber_source(texture, numbers);
        if (texture.contains("extensions") && texture["extensions"].is_object())
            for (GltfJson& extension : texture["extensions"]) renumber_source(extension, numbers);
    }
    return textures;
}

// Of the objects in `value`, but not of what their extras hold.
void collect_extensions(const GltfJson& value, std::set<std::string>& names)
{
    if (value.is_object() && value.contains("extensions") && value["extensions"].is_object())
        for (const auto& extension : value["extensions"].items()) names.insert(extension.key());
    if (value.is_structured())
        for (const auto& item : value.items())
            if (item.key() != "extras") collect_extensions(item.value(), names);
}

// Textures that a material or one of its extensions names.
void check_textures(const GltfValue& value, std::size_t texture_count)
{
    if (!value.exists() || !value.json().is_object()) return;
    constexpr std::string_view ending = "Texture";
    for (const auto& item : value.json().items()) {
        const std::string& key = item.key();
        if (key == "extras") continue;
        const GltfValue member = value[key];
        const bool is_texture
            = key.size() > ending.size() && key.compare(key.size() - ending.size(), ending.size(), ending) == 0;
        if (is_texture) member["index"].index(texture_count, "textures");
        check_textures(member, texture_count);
    }
}

// They are copied more than once, and characters need thousands.
void limit_text(const GltfDocument& document)
{
    constexpr std::size_t most_bytes = std::size_t(1) << 22;
    std::size_t total = 0;
    for (const char* key : { "materials", "samplers", "textures" }) {
        for (std::size_t i = 0; i < document[key].size(); ++i) {
            const GltfValue entry = document[key].at(i);
            if (!entry.json().is_object()) entry.fail(2306, "an object expected");
            total += entry.json().dump(-1, ' ', false, GltfJson::error_handler_t::replace).size();
            if (total > most_bytes)
                entry.fail(2306, fmt::format("makes the materials {} bytes of JSON, the limit is {}", total, most_bytes),
                           "leave out their extras, or the materials");
        }
    }
}

} // namespace

void check_materials(const GltfDocument& document)
{
    constexpr std::size_t most_images = 4096; // each is looked for on the disk
    const GltfValue textures = document["textures"], materials = document["materials"], images = document["images"];
    if (images.size() > most_images)
        images.fail(2306, fmt::format("has {} images, the limit is {}", images.size(), most_images),
                    "leave out the materials, or join images");
    for (std::size_t i = 0; i < textures.size(); ++i) {
        textures.at(i)["source"].index_or_none(document["images"].size(), "images");
        textures.at(i)["sampler"].index_or_none(document["samplers"].size(), "samplers");
    }
    limit_text(document);
    for (std::size_t i = 0; i < materials.size(); ++i) {
        check_textures(materials.at(i), textures.size());
        const GltfValue factor = materials.at(i)["pbrMetallicRoughness"]["baseColorFactor"];
        if (factor.exists()) factor.numbers(4);
    }
}

void list_extensions(const GltfDocument& document, GltfJson& materials)
{
    std::set<std::string> names;
    collect_extensions(materials, names);
    if (!names.empty()) materials["extensionsUsed"] = names;
    const GltfValue required = document["extensionsRequired"];
    for (std::size_t i = 0; i < required.size(); ++i)
        if (names.erase(required.at(i).text()) != 0) materials["extensionsRequired"].push_back(required.at(i).text());
}

RenderScene render_scene(const GltfScene& scene, const Positions& normals, std::vector<Diagnostic>& warnings)
{
    const GltfDocument& document = *scene.document;
    RenderScene out;
    out.path = document.path();
    out.vertex_count = static_cast<std::uint32_t>(scene.vertex_count());
    out.triangles = triangles_of(scene);
    put_parts(scene, normals, out);
    check_materials(document);
    GltfJson materials = GltfJson::object();
    for (const char* key : { "materials", "samplers" })
        if (document[key].size() != 0) materials[key] = document[key].json();
    std::vector<int> numbers;
    GltfJson images = take_images(document, out, numbers, warnings);
    if (!images.empty()) materials["images"] = std::move(images);
    if (document["textures"].size() != 0) materials["textures"] = textures_of(document, numbers);
    list_extensions(document, materials);
    out.materials = materials.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
    return out;
}

} // namespace pliant
