#include "output/export/glb.h"

#include "base/common/diagnostics.h"
#include "base/common/version.h"
#include "output/export/compress_view.h"
#include "pliant_format.h"

#include <algorithm>
#include <cstring>
#include <fmt/core.h>

namespace pliant {

namespace {

constexpr const char* compression = "EXT_meshopt_compression";
constexpr std::size_t most_small_indices = 0xFFFF; // vertices: the index 65535 would mean "restart"

template <class T> std::string_view bytes_of(const std::vector<T>& values)
{
    return { reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T) };
}

void append_word(std::string& out, std::uint64_t value)
{
    const auto word = std::uint32_t(value);
    out.append(reinterpret_cast<const char*>(&word), sizeof word);
}

void pad(std::string& out, std::size_t alignment, char filling)
{
    out.append((alignment - out.size() % alignment) % alignment, filling);
}

const char* type_of(int width)
{
    switch (width) {
    case 1: return "SCALAR";
    case 2: return "VEC2";
    case 3: return "VEC3";
    case 4: return "VEC4";
    default: return "MAT4";
    }
}

} // namespace

void check_glb_size(std::uint64_t size)
{
    if (size > 0xFFFFFFFFull)
        throw Failure(ExitCode::failed,
                      error_at(5201, "", fmt::format("the GLB would have {} bytes, the limit of the format is 4 GiB", size),
                               "bake with a smaller --dim, or export with --embed or --skin instead of --morph"));
}

Glb::Glb(std::string_view leading, bool with_compression)
    : leading_size_(leading.size())
    , with_compression_(with_compression)
{
    json_["asset"] = { { "version", "2.0" }, { "generator", baker_version } };
    json_["buffers"] = Json::array({ Json::object() });
    json_["bufferViews"] = Json::array();
    json_["accessors"] = Json::array();
    if (!leading.empty()) add_view(leading);
    if (!with_compression) return;
    json_["buffers"].push_back({ { "byteLength", 0 }, { "extensions", { { compression, { { "fallback", true } } } } } });
    use_extension(compression, true);
}

void Glb::use_extension(const std::string& name, bool is_required)
{
    used_extensions_.insert(name);
    if (is_required) required_extensions_.insert(name);
}

std::size_t Glb::append(std::string_view bytes)
{
    pad(binary_, 4, '\0');
    check_glb_size(std::uint64_t(binary_.size()) + bytes.size());
    binary_.append(bytes);
    return binary_.size() - bytes.size();
}

std::size_t Glb::add_view(std::string_view bytes, Target target)
{
    Json view = { { "buffer", 0 }, { "byteOffset", append(bytes) }, { "byteLength", bytes.size() } };
    if (target != Target::none) view["target"] = int(target);
    json_["bufferViews"].push_back(view);
    return json_["bufferViews"].size() - 1;
}

std::size_t Glb::add_shared_view(std::string_view bytes)
{
    // Linear in all bytes for any of them: memmem() is, and no byte is searched twice.
    const void* found = memmem(binary_.data() + searched_size_, leading_size_ - searched_size_, bytes.data(), bytes.size());
    if (!found) {
        searched_size_ = leading_size_;
        return add_view(bytes);
    }
    const std::size_t offset = static_cast<std::size_t>(static_cast<const char*>(found) - binary_.data());
    searched_size_ = offset + bytes.size();
    json_["bufferViews"].push_back({ { "buffer", 0 }, { "byteOffset", offset }, { "byteLength", bytes.size() } });
    return json_["bufferViews"].size() - 1;
}

// A view of equal elements. Compressed ones lie in buffer 0 and say where in buffer 1 they are unpacked to.
std::size_t Glb::add_elements(std::string_view bytes, std::size_t stride, Target target)
{
    if (!with_compression_ || bytes.empty()) return add_view(bytes, target);
    const std::string packed = target == Target::indices ? compress_triangles(bytes, stride) : compress_rows(bytes, stride);
    Json view = { { "buffer", 1 }, { "byteOffset", unpacked_size_ }, { "byteLength", bytes.size() } };
    if (target != Target::none) view["target"] = int(target);
    view["extensions"][compression] = { { "buffer", 0 },
                                        { "byteOffset", append(packed) },
                                        { "byteLength", packed.size() },
                                        { "byteStride", stride },
                                        { "mode", target == Target::indices ? "TRIANGLES" : "ATTRIBUTES" },
                                        { "count", bytes.size() / stride } };
    json_["bufferViews"].push_back(view);
    unpacked_size_ = (unpacked_size_ + bytes.size() + 3) / 4 * 4;
    return json_["bufferViews"].size() - 1;
}

std::size_t Glb::add_accessor(std::size_t view, int component, std::size_t count, const char* type)
{
    json_["accessors"].push_back(
        { { "bufferView", view }, { "componentType", component }, { "count", count }, { "type", type } });
    return json_["accessors"].size() - 1;
}

template <class T> void Glb::bound(std::size_t accessor, const std::vector<T>& values, int width)
{
    Json low = Json::array(), high = Json::array();
    for (int c = 0; c < width; ++c) {
        T least = values[std::size_t(c)], most = least;
        for (std::size_t i = std::size_t(c); i < values.size(); i += std::size_t(width)) {
            least = std::min(least, values[i]);
            most = std::max(most, values[i]);
        }
        low.push_back(least);
        high.push_back(most);
    }
    json_["accessors"][accessor]["min"] = low;
    json_["accessors"][accessor]["max"] = high;
}

std::size_t Glb::add_floats(const std::vector<float>& values, int width, Target target, bool with_bounds)
{
    const std::size_t view = add_elements(bytes_of(values), std::size_t(width) * sizeof(float), target);
    const std::size_t accessor = add_accessor(view, gltf_float32, values.size() / std::size_t(width), type_of(width));
    if (with_bounds) bound(accessor, values, width);
    return accessor;
}

std::size_t Glb::add_integers(const std::vector<std::int16_t>& values, int width, GltfComponentType component,
                              bool is_normalised, bool with_bounds)
{
    const std::size_t size = component == gltf_int8 ? 1 : 2, used = std::size_t(width) * size, stride = (used + 3) / 4 * 4;
    const std::size_t count = values.size() / std::size_t(width);
    std::string bytes(count * stride, '\0');
    for (std::size_t i = 0; i < values.size(); ++i) // little-endian: the low byte is the first
        std::copy_n(reinterpret_cast<const char*>(&values[i]), size,
                    &bytes[i / std::size_t(width) * stride + i % std::size_t(width) * size]);
    const std::size_t view = add_elements(bytes, stride, Target::vertices);
    if (stride != used) json_["bufferViews"][view]["byteStride"] = stride;
    const std::size_t accessor = add_accessor(view, component, count, type_of(width));
    if (is_normalised) json_["accessors"][accessor]["normalized"] = true;
    if (with_bounds) bound(accessor, values, width);
    use_extension("KHR_mesh_quantization", true);
    return accessor;
}

std::size_t Glb::add_indices(const std::vector<std::uint32_t>& indices, std::size_t vertex_count)
{
    const bool fits = vertex_count <= most_small_indices;
    const std::vector<std::uint16_t> small(indices.begin(), fits ? indices.end() : indices.begin());
    const std::size_t view = add_elements(fits ? bytes_of(small) : bytes_of(indices), fits ? 2 : 4, Target::indices);
    return add_accessor(view, fits ? gltf_uint16 : gltf_uint32, indices.size(), "SCALAR");
}

std::size_t Glb::add_joints(const std::vector<std::uint16_t>& joints)
{
    const bool fits = joints.empty() || *std::max_element(joints.begin(), joints.end()) < 256;
    const std::vector<std::uint8_t> small(joints.begin(), fits ? joints.end() : joints.begin());
    const std::size_t view = add_elements(fits ? bytes_of(small) : bytes_of(joints), fits ? 4 : 8, Target::vertices);
    return add_accessor(view, fits ? gltf_uint8 : gltf_uint16, joints.size() / 4, "VEC4");
}

std::string Glb::bytes() const
{
    Json json = json_;
    json["buffers"][0]["byteLength"] = binary_.size();
    if (with_compression_) json["buffers"][1]["byteLength"] = unpacked_size_;
    if (!used_extensions_.empty()) json["extensionsUsed"] = used_extensions_;
    if (!required_extensions_.empty()) json["extensionsRequired"] = required_extensions_;
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    constexpr std::size_t head = 12 + 8, binary_head = 8;
    // Spaces at the end of the JSON until the binary chunk's first byte is on a page.
    const std::size_t start = head + text.size() + binary_head;
    text.append((PLIANT_FORMAT_BASIS_ALIGNMENT - start % PLIANT_FORMAT_BASIS_ALIGNMENT) % PLIANT_FORMAT_BASIS_ALIGNMENT,
                ' ');
    std::string binary = binary_;
    pad(binary, 4, '\0');
    const std::uint64_t total = std::uint64_t(head) + text.size() + binary_head + binary.size();
    check_glb_size(total);
    std::string out = "glTF";
    append_word(out, 2);
    append_word(out, total);
    append_word(out, text.size());
    out += "JSON" + text;
    append_word(out, binary.size());
    out.append("BIN\0", 4);
    return out + binary;
}

} // namespace pliant
