#include "elastic_model.h"

#include "draw/image_reader.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace game {

namespace {

constexpr char extension[] = "PLIANT_elastic_blend";

void check(pliant_result result, const std::string& what)
{
    if (result != PLIANT_OK) throw std::runtime_error(what + ": " + pliant_result_text(result));
}

// 8-aligned memory of at least so many bytes, from a multiple of 16 on.
void* aligned(std::vector<std::uint64_t>& memory, std::size_t size)
{
    memory.resize(size / 8 + 3);
    const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
    return memory.data() + (address % 16 ? 1 : 0);
}

// By libpng and libjpeg: stb_image, which tinygltf has, writes out of bounds where a JPEG file of a stranger wants it to.
// Without pixels the texture is left out.
void decode(tinygltf::Image& image, const unsigned char* bytes, std::size_t size)
{
    constexpr std::size_t most_bytes = std::size_t(1) << 28;
    pliant::player::Image read = pliant::player::read_image(bytes, size, [](std::size_t pixel_bytes) {
        if (pixel_bytes > most_bytes) throw std::runtime_error("a texture is too large");
    });
    image.width = read.width;
    image.height = read.height;
    image.component = 4;
    image.bits = 8;
    image.pixel_type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    image.image = std::move(read.pixels);
}

// tinygltf does not check whether a view lies in its buffer: images in views are decoded later.
bool decode_file(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
                 void*)
{
    if (image->bufferView < 0) decode(*image, bytes, static_cast<std::size_t>(size));
    return true;
}

// The first byte of a view, all of which lies in its buffer.
const unsigned char* bytes_of(const tinygltf::Model& model, const tinygltf::BufferView& view)
{
    const std::vector<unsigned char>& buffer = model.buffers.at(std::size_t(view.buffer)).data;
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
        throw std::runtime_error("a buffer view reaches beyond its buffer");
    return buffer.data() + view.byteOffset;
}

// tinygltf reads nested values by recursion, so deep nesting would overflow the stack. Exporters nest a dozen levels.
void check_nesting(const std::string& glb)
{
    constexpr std::size_t head_size = 20;
    constexpr int most = 64;
    std::uint32_t json_size = 0;
    if (glb.size() >= head_size) std::memcpy(&json_size, &glb[12], 4);
    const std::size_t end = std::min(glb.size(), head_size + json_size);
    int depth = 0;
    bool is_string = false;
    for (std::size_t i = head_size; i < end; ++i) {
        if (glb[i] == '"') is_string = !is_string;
        if (is_string && glb[i] == '\\') ++i; // with the character that it escapes
        if (is_string) continue;
        depth += glb[i] == '{' || glb[i] == '[';
        depth -= glb[i] == '}' || glb[i] == ']';
        if (depth > most) throw std::runtime_error("the JSON is nested deeper than 64 values");
    }
}

std::string read_file(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(file), {});
    if (!file || bytes.size() > std::numeric_limits<std::uint32_t>::max())
        throw std::runtime_error(path + ": cannot be read");
    return bytes;
}

tinygltf::Model load(const std::string& path)
{
    const std::string glb = read_file(path);
    check_nesting(glb);
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(decode_file, nullptr);
    loader.SetFsCallbacks({}); // the GLB is whole, and names no other files to open
    tinygltf::Model model;
    std::string error, warning;
    if (!loader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
                                     std::uint32_t(glb.size())))
        throw std::runtime_error(path + ": " + (error.empty() ? "cannot be read as a GLB" : error));
    for (const std::string& name : model.extensionsRequired)
        if (name != extension && name != "KHR_mesh_quantization")
            throw std::runtime_error(path + ": needs the extension " + name + ", which this sample does not read");
    for (tinygltf::Image& image : model.images) {
        if (image.bufferView < 0) continue;
        const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(image.bufferView));
        decode(image, bytes_of(model, view), view.byteLength);
    }
    return model;
}

// The first byte of an element of an accessor, and the bytes from one to the next. Every element lies in the buffer, and
// has at least `least_size` bytes.
struct Elements {
    const unsigned char* first;
    std::size_t stride, count;
};

Elements elements_of(const tinygltf::Model& model, int number, std::size_t least_size)
{
    const tinygltf::Accessor& accessor = model.accessors.at(std::size_t(number));
    const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(accessor.bufferView));
    const tinygltf::Buffer& buffer = model.buffers.at(std::size_t(view.buffer));
    const int stride = accessor.ByteStride(view);
    const std::size_t size = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType))
                                         * tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type))),
                      room = buffer.data.size();
    if (stride <= 0 || size < least_size || view.byteOffset > room || accessor.byteOffset > room - view.byteOffset)
        throw std::runtime_error("an accessor has other numbers than it should, or begins beyond its buffer");
    const std::size_t begin = view.byteOffset + accessor.byteOffset, left = room - begin;
    if (accessor.count > 0 && (left < size || accessor.count - 1 > (left - size) / std::size_t(stride)))
        throw std::runtime_error("an accessor reaches beyond its buffer");
    return { buffer.data.data() + begin, std::size_t(stride), accessor.count };
}

std::vector<std::uint32_t> indices_of(const tinygltf::Model& model, const tinygltf::Primitive& primitive)
{
    const tinygltf::Accessor& accessor = model.accessors.at(std::size_t(primitive.indices));
    const std::size_t size = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ? 1
        : accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT                   ? 2
                                                                                             : 4;
    const Elements elements = elements_of(model, primitive.indices, size);
    std::vector<std::uint32_t> indices(elements.count);
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const unsigned char* at = elements.first + i * elements.stride;
        if (size == 1) {
            indices[i] = *at;
        } else if (size == 2) {
            std::uint16_t index;
            std::memcpy(&index, at, 2);
            indices[i] = index;
        } else {
            std::memcpy(&indices[i], at, 4);
        }
    }
    return indices;
}

std::uint32_t index_in(const tinygltf::Value& value)
{
    const double number = value.GetNumberAsDouble(); // 0 of what is no number
    if (!(number >= 0 && number <= std::numeric_limits<std::uint32_t>::max()))
        throw std::runtime_error("an index is out of range");
    return std::uint32_t(number);
}

// What the extras say of the primitive's vertices (formats/SPEC.md, section 7): `first_vertex` is the asset's number of
// vertex 0, and those from `vertex_count` on are not the asset's.
std::uint32_t extra_of(const tinygltf::Primitive& primitive, const char* name, std::uint32_t otherwise)
{
    if (!primitive.extras.Has("pliant")) return otherwise;
    const tinygltf::Value& ours = primitive.extras.Get("pliant");
    return ours.Has(name) ? index_in(ours.Get(name)) : otherwise;
}

} // namespace

ElasticModel::ElasticModel(const std::string& path)
    : gltf_(load(path))
{
    const auto mesh = std::find_if(gltf_.meshes.begin(), gltf_.meshes.end(), [](const tinygltf::Mesh& candidate) {
        return candidate.extensions.count(extension) > 0;
    });
    if (mesh == gltf_.meshes.end())
        throw std::runtime_error(path + ": no mesh has the extension " + extension
                                 + "; write it with `pliant export --embed`");
    open_asset(*mesh);
    for (const tinygltf::Primitive& primitive : mesh->primitives) read_part(primitive);
    blend(initial_weights());
}

pliant_weight ElasticModel::weight(std::uint32_t index) const
{
    pliant_weight found {};
    check(pliant_asset_weight(&asset_, index, &found), "the weights");
    return found;
}

std::vector<float> ElasticModel::initial_weights() const
{
    std::vector<float> weights;
    for (std::uint32_t k = 0; k < weight_count(); ++k) weights.push_back(weight(k).initial);
    return weights;
}

// The runtime opens the asset in place. tinygltf's buffer is not aligned for it, so it is copied once.
void ElasticModel::open_asset(const tinygltf::Mesh& mesh)
{
    const tinygltf::BufferView& view = gltf_.bufferViews.at(index_in(mesh.extensions.at(extension).Get("bufferView")));
    const unsigned char* bytes = bytes_of(gltf_, view);
    void* blob = aligned(blob_, view.byteLength);
    std::memcpy(blob, bytes, view.byteLength);
    check(pliant_asset_open(&asset_, blob, view.byteLength, 0), "the asset cannot be opened");

    const pliant_solver_desc desc = pliant_solver_desc_default();
    const std::size_t solver_size = pliant_solver_memory(&asset_, &desc), normals_size = pliant_normals_memory(&asset_);
    check(pliant_solver_init(&solver_, &asset_, &desc, aligned(solver_memory_, solver_size), solver_size), "the solver");
    check(pliant_normals_init(&normals_, &asset_, aligned(normals_memory_, normals_size), normals_size), "the normals");
    q_.resize(asset_.dimension);
    vertices_.resize(asset_.vertex_count); // those inside a solid are in no triangle
}

void ElasticModel::read_part(const tinygltf::Primitive& primitive)
{
    const std::uint32_t first = extra_of(primitive, "first_vertex", 0),
                        count = extra_of(primitive, "vertex_count", UINT32_MAX);
    Part part;
    for (const std::uint32_t index : indices_of(gltf_, primitive)) {
        if (index >= count) continue; // the last triangle, without area, which only holds a bounding box
        part.indices.push_back(first + index);
        if (first + index >= vertices_.size())
            throw std::runtime_error("a triangle has a vertex that the asset does not have");
    }
    corner_count_ += part.indices.size();
    if (corner_count_ > 3 * std::size_t(asset_.triangle_count))
        throw std::runtime_error("the parts have more triangles than the asset");
    const auto uv = primitive.attributes.find("TEXCOORD_0");
    if (uv != primitive.attributes.end()
        && gltf_.accessors.at(std::size_t(uv->second)).componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) {
        const Elements elements = elements_of(gltf_, uv->second, sizeof(Vertex::uv));
        for (std::size_t i = 0; i < std::min<std::size_t>(elements.count, count) && first + i < vertices_.size(); ++i)
            std::memcpy(vertices_[first + i].uv, elements.first + i * elements.stride, sizeof(Vertex::uv));
    }
    if (primitive.material >= 0) {
        const auto& surface = gltf_.materials.at(std::size_t(primitive.material)).pbrMetallicRoughness;
        std::copy_n(surface.baseColorFactor.begin(), std::min<std::size_t>(4, surface.baseColorFactor.size()), part.color);
        if (surface.baseColorTexture.index >= 0)
            part.image = gltf_.textures.at(std::size_t(surface.baseColorTexture.index)).source;
    }
    parts_.push_back(std::move(part));
}

// What a game does in every frame in which the weights changed: solve for some dozens of coordinates, then rebuild the
// vertices, here straight into the array that goes to the graphics processor.
void ElasticModel::blend(const std::vector<float>& weights)
{
    if (weights.size() != weight_count())
        throw std::runtime_error(std::to_string(weights.size()) + " weights for " + std::to_string(weight_count())
                                 + (has_layers() ? " layers" : " poses"));
    pliant_solve_info info;
    check(pliant_solve(solver_, weights.data(), q_.data(), &info), "the weights");
    const auto count = std::uint32_t(vertices_.size());
    pliant_reconstruct(&asset_, q_.data(), 0, count, vertices_[0].position, sizeof(Vertex));
    pliant_normals_compute(&normals_, vertices_[0].position, sizeof(Vertex), 0, count, vertices_[0].normal, sizeof(Vertex));
}

} // namespace game
