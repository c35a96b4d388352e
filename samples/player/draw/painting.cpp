#include "draw/painting.h"

#include "blend/error.h"

#include <pliant_format.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

namespace pliant::player {
namespace {

using Json = nlohmann::json;

enum ComponentType { uint16 = 5123, uint32 = 5125, float32 = 5126 };
enum Setting { nearest = 9728, clamp_to_edge = 33071, mirrored_repeat = 33648 };
constexpr std::uint64_t json_size_limit = std::uint64_t(1) << 24; // parsed it takes up to forty times as much

// Bytes of pixels that are believed of any file, and of each of its bytes.
constexpr std::size_t free_pixel_size = std::size_t(1) << 28, pixel_size_per_byte = 64;

constexpr std::uint32_t json_tag = 0x4e4f534a, binary_tag = 0x004e4942;

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

const Json& none()
{
    static const Json value;
    return value;
}

// A member, or null.
const Json& member(const Json& object, const char* name)
{
    if (!object.is_object()) return none();
    const auto found = object.find(name);
    return found == object.end() ? none() : *found;
}

// An element of a list; throws if the list has no such element.
const Json& element(const Json& list, std::uint64_t i, const char* what)
{
    if (!list.is_array() || i >= list.size()) refuse(std::string("there is no such ") + what);
    return list[static_cast<std::size_t>(i)];
}

std::uint64_t whole(const Json& object, const char* name, std::optional<std::uint64_t> missing = std::nullopt)
{
    const Json& value = member(object, name);
    if (value.is_null() && missing) return *missing;
    if (!value.is_number_unsigned()) refuse(std::string(name) + " is not a whole number");
    return value.get<std::uint64_t>();
}

float number(const Json& object, const char* name, float missing)
{
    const Json& value = member(object, name);
    if (value.is_null()) return missing;
    const double found = value.is_number() ? value.get<double>() : std::nan("");
    if (!std::isfinite(found)) refuse(std::string(name) + " is not a number");
    return static_cast<float>(found);
}

template <int N> glm::vec<N, float> vector_of(const Json& object, const char* name, glm::vec<N, float> missing)
{
    const Json& list = member(object, name);
    if (list.is_null()) return missing;
    if (!list.is_array() || list.size() != N) refuse(std::string(name) + " has another size");
    glm::vec<N, float> result;
    for (int c = 0; c < N; ++c) {
        if (!list[static_cast<std::size_t>(c)].is_number()) refuse(std::string(name) + " is not a list of numbers");
        result[c] = list[static_cast<std::size_t>(c)].get<float>();
    }
    return result;
}

struct Bytes {
    const std::uint8_t* data = nullptr;
    std::uint64_t size = 0;

    template <class T> T at(std::uint64_t i) const
    {
        T value;
        std::memcpy(&value, data + i * sizeof value, sizeof value);
        return value;
    }
};

// The chunk, which is a binary glTF file.
struct Document {
    Json json;
    Bytes binary;

    explicit Document(Bytes chunk)
    {
        if (chunk.size < 28 || std::memcmp(chunk.data, "glTF", 4) != 0) refuse("not binary glTF");
        const std::uint64_t text = chunk.at<std::uint32_t>(3);
        if (chunk.at<std::uint32_t>(4) != json_tag || text % 4 != 0 || text > chunk.size - 28) refuse("not binary glTF");
        const std::uint64_t size = chunk.at<std::uint32_t>(5 + text / 4);
        if (chunk.at<std::uint32_t>(6 + text / 4) != binary_tag || size > chunk.size - 28 - text) refuse("not binary glTF");
        if (text > json_size_limit) refuse("more JSON than any file has");
        json = Json::parse(chunk.data + 20, chunk.data + 20 + text);
        binary = { chunk.data + 28 + text, size };
    }

    Bytes view(std::uint64_t index) const
    {
        const Json& view = element(member(json, "bufferViews"), index, "view");
        const std::uint64_t offset = whole(view, "byteOffset", 0), size = whole(view, "byteLength");
        if (offset > binary.size || size > binary.size - offset) refuse("a buffer view ends outside its buffer");
        return { binary.data + offset, size };
    }

    // The data of an accessor: `count` elements of `width` numbers of `bytes` bytes each, without gaps (SPEC.md).
    Bytes numbers(const Json& accessor, std::uint64_t count, std::uint64_t width, std::uint64_t bytes) const
    {
        const Bytes all = view(whole(accessor, "bufferView"));
        const std::uint64_t offset = whole(accessor, "byteOffset", 0);
        if (offset > all.size || count > (all.size - offset) / (width * bytes))
            refuse("an accessor ends outside its buffer view");
        return { all.data + offset, count * width * bytes };
    }
};

void take(std::size_t& left, std::size_t size)
{
    if (size > left) refuse("its images are larger than those of a file of its size should be");
    left -= size;
}

// Numbers of `painting.images`, one for each image of the file; images of the same bytes are one.
std::vector<std::size_t> read_images(const Document& document, Painting& painting)
{
    std::map<std::pair<const std::uint8_t*, std::uint64_t>, std::size_t> known; // by place and size
    std::size_t pixels_left = free_pixel_size + pixel_size_per_byte * static_cast<std::size_t>(document.binary.size),
                bytes_left = 2 * static_cast<std::size_t>(document.binary.size); // views may overlap
    std::vector<std::size_t> numbers;
    for (const Json& image : member(document.json, "images")) {
        const Json& view = member(image, "bufferView");
        const Bytes bytes = view.is_null() ? Bytes {} : document.view(whole(image, "bufferView"));
        const auto [place, is_new] = known.emplace(std::pair(bytes.data, bytes.size), known.size());
        numbers.push_back(place->second);
        if (!is_new) continue;
        const std::size_t size = static_cast<std::size_t>(bytes.size);
        take(bytes_left, size);
        painting.images.push_back(
            read_image(bytes.data, size, [&](std::size_t pixel_size) { take(pixels_left, pixel_size); }));
    }
    return numbers;
}

Wrap wrap_of(const Json& sampler, const char* name)
{
    switch (whole(sampler, name, 0)) {
    case clamp_to_edge: return Wrap::clamp;
    case mirrored_repeat: return Wrap::mirror;
    default: return Wrap::repeat;
    }
}

// One for each texture of the file. A texture without a readable image gets the number of images as its index.
void read_textures(const Document& document, Painting& painting)
{
    const std::vector<std::size_t> numbers = read_images(document, painting);
    for (const Json& texture : member(document.json, "textures")) {
        Texture result;
        result.image = painting.images.size();
        if (!member(texture, "source").is_null()) {
            const std::uint64_t source = whole(texture, "source");
            if (source >= numbers.size()) refuse("there is no such image");
            const std::size_t image = numbers[static_cast<std::size_t>(source)];
            if (!painting.images[image].pixels.empty()) result.image = image;
        }
        if (!member(texture, "sampler").is_null()) {
            const Json& sampler = element(member(document.json, "samplers"), whole(texture, "sampler"), "sampler");
            result.wrap_x = wrap_of(sampler, "wrapS");
            result.wrap_y = wrap_of(sampler, "wrapT");
            result.nearest = whole(sampler, "magFilter", 0) == nearest;
        }
        painting.textures.push_back(result);
    }
}

// The transform of texture coordinates by KHR_texture_transform; its rotation is clockwise in the texture.
struct Placing {
    glm::vec2 offset { 0.0f }, scale { 1.0f };
    float angle = 0.0f;

    glm::vec2 operator()(glm::vec2 at) const
    {
        const float x = at.x * scale.x, y = at.y * scale.y, c = std::cos(angle), s = std::sin(angle);
        return { c * x + s * y + offset.x, c * y - s * x + offset.y };
    }
};

struct Material {
    PaintedPart part;
    std::string places = "TEXCOORD_0"; // the attribute with its texture coordinates
    Placing placing;
};

Material material_of(const Document& document, const Json& primitive, const Painting& painting)
{
    Material result;
    if (member(primitive, "material").is_null()) return result;
    const Json& material = element(member(document.json, "materials"), whole(primitive, "material"), "material");
    const Json& metallic_roughness = member(material, "pbrMetallicRoughness");
    result.part.factor = vector_of<4>(metallic_roughness, "baseColorFactor", glm::vec4(1.0f));
    result.part.cutoff = number(material, "alphaCutoff", 0.5f);
    const Json& mode = member(material, "alphaMode");
    if (mode == "MASK") result.part.alpha = Alpha::mask;
    if (mode == "BLEND") result.part.alpha = Alpha::blend;
    const Json& texture = member(metallic_roughness, "baseColorTexture");
    if (texture.is_null()) return result;
    const std::uint64_t index = whole(texture, "index");
    if (index >= painting.textures.size()) refuse("there is no such texture");
    if (painting.textures[index].image < painting.images.size()) result.part.texture = index;
    const Json& transform = member(member(texture, "extensions"), "KHR_texture_transform");
    const std::uint64_t set = whole(transform, "texCoord", whole(texture, "texCoord", 0));
    result.places = "TEXCOORD_" + std::to_string(set);
    result.placing = { vector_of<2>(transform, "offset", glm::vec2(0.0f)), vector_of<2>(transform, "scale", glm::vec2(1.0f)),
                       number(transform, "rotation", 0.0f) };
    return result;
}

// Calls use(v, value) for each vertex v of a float attribute; returns false if the primitive does not have it. width: the
// required number of components; 0 accepts 3 or 4.
template <class Use>
bool read_attribute(const Document& document, const Json& primitive, const std::string& name, std::uint64_t count,
                    std::uint64_t width, Use&& use)
{
    const Json& index = member(member(primitive, "attributes"), name.c_str());
    if (index.is_null()) return false;
    if (!index.is_number_unsigned()) refuse(name + " is not an accessor");
    const Json& accessor = element(member(document.json, "accessors"), index.get<std::uint64_t>(), "accessor");
    const Json& type = member(accessor, "type");
    if (width == 0) width = type == "VEC4" ? 4 : 3;
    if (type != "VEC" + std::to_string(width) || whole(accessor, "componentType") != float32
        || whole(accessor, "count") != count)
        refuse(name + " has another type or size than its part");
    const Bytes values = document.numbers(accessor, count, width, sizeof(float));
    for (std::uint64_t v = 0; v < count; ++v) {
        glm::vec4 value { 0.0f, 0.0f, 0.0f, 1.0f };
        for (std::uint64_t c = 0; c < width; ++c) value[static_cast<int>(c)] = values.at<float>(width * v + c);
        use(v, value);
    }
    return true;
}

void read_indices(const Document& document, const Json& primitive, std::uint32_t first, std::uint64_t count,
                  Painting& painting)
{
    if (member(primitive, "indices").is_null()) return; // no faces
    const Json& accessor = element(member(document.json, "accessors"), whole(primitive, "indices"), "accessor");
    const std::uint64_t type = whole(accessor, "componentType"), corners = whole(accessor, "count");
    if ((type != uint16 && type != uint32) || corners % 3 != 0) refuse("the indices are not triangles");
    const Bytes values = document.numbers(accessor, corners, 1, type == uint16 ? 2 : 4);
    if (painting.indices.size() + corners > document.binary.size / 2) refuse("parts share their triangles");
    for (std::uint64_t i = 0; i < corners; ++i) {
        const std::uint32_t vertex = type == uint16 ? values.at<std::uint16_t>(i) : values.at<std::uint32_t>(i);
        if (vertex >= count) refuse("an index is outside its part");
        painting.indices.push_back(first + vertex);
    }
}

// Returns whether the part has a material or colours.
bool read_part(const Document& document, const Json& primitive, std::uint32_t first, std::uint64_t count, Painting& painting)
{
    const Material material = material_of(document, primitive, painting);
    PaintedPart part = material.part;
    const auto at
        = [&](std::uint64_t v) -> PaintedVertex& { return painting.vertices[first + static_cast<std::size_t>(v)]; };
    const bool has_places
        = read_attribute(document, primitive, material.places, count, 2,
                         [&](std::uint64_t v, const glm::vec4& value) { at(v).place = material.placing(glm::vec2(value)); });
    if (!has_places) part.texture.reset();
    const bool has_colours = read_attribute(document, primitive, "COLOR_0", count, 0,
                                            [&](std::uint64_t v, const glm::vec4& value) { at(v).colour = value; });
    part.first_index = static_cast<std::uint32_t>(painting.indices.size());
    read_indices(document, primitive, first, count, painting);
    part.index_count = static_cast<std::uint32_t>(painting.indices.size()) - part.first_index;
    if (part.index_count != 0) painting.parts.push_back(part);
    return has_colours || !member(primitive, "material").is_null();
}

std::optional<Painting> read_painting(Bytes chunk, std::uint32_t vertex_count, std::uint32_t drawn_count)
{
    const Document document(chunk);
    Painting painting;
    painting.vertices.resize(vertex_count);
    read_textures(document, painting);
    std::uint64_t first = 0;
    bool is_painted = false;
    for (const Json& primitive : member(element(member(document.json, "meshes"), 0, "mesh"), "primitives")) {
        const Json& extras = member(primitive, "extras");
        const std::uint64_t count = whole(extras, "vertex_count");
        if (whole(extras, "first_vertex") != first || count > drawn_count - first) refuse("parts do not follow each other");
        is_painted |= read_part(document, primitive, static_cast<std::uint32_t>(first), count, painting);
        first += count;
    }
    if (first != drawn_count) refuse("its parts do not cover all vertices");
    if (!is_painted) return std::nullopt;
    return painting;
}

} // namespace

std::optional<Painting> painting_of(const AssetFile& file)
{
    const pliant_asset& asset = file.view();
    std::size_t size = 0;
    const void* chunk = pliant_asset_chunk(&asset, PLIANT_CHUNK_SCENE, &size);
    if (!chunk) return std::nullopt;
    try {
        return read_painting({ static_cast<const std::uint8_t*>(chunk), size }, asset.vertex_count,
                             asset.boundary_vertex_count);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) { // our own refusals, and those of the JSON parser
        throw Error(ErrorNumber::asset_refused, ExitCode::bad_input,
                    file.path() + ": its materials (chunk GLTF): " + error.what(),
                    "bake the asset again, or show it with --plain");
    }
}

} // namespace pliant::player
