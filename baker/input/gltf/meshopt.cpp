#include "input/gltf/meshopt.h"

#include "input/io/source_file.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

namespace pliant {
namespace {

constexpr const char* damaged_view = "the file is damaged: compress it again from the original";

struct Packing {
    std::uint64_t count = 0, stride = 0;
    std::string mode, filter;
};

// What the extension's table of rules says.
const char* fault_of(const Packing& p)
{
    if (p.mode == "ATTRIBUTES") {
        if (p.stride % 4 != 0 || p.stride == 0 || p.stride > 256) return "ATTRIBUTES need a byteStride of 4, 8, ... 256";
        if (p.filter == "OCTAHEDRAL" && p.stride != 4 && p.stride != 8) return "OCTAHEDRAL needs a byteStride of 4 or 8";
        if (p.filter == "QUATERNION" && p.stride != 8) return "QUATERNION needs a byteStride of 8";
        return nullptr;
    }
    if (p.stride != 2 && p.stride != 4) return "TRIANGLES and INDICES need a byteStride of 2 or 4";
    if (p.filter != "NONE") return "TRIANGLES and INDICES have no filter";
    return p.mode == "TRIANGLES" && p.count % 3 != 0 ? "TRIANGLES need a multiple of 3 elements" : nullptr;
}

Packing packing_of(const GltfValue& view, const GltfValue& extension)
{
    const Packing p { extension["count"].whole(), extension["byteStride"].whole(), extension["mode"].text(),
                      extension["filter"].text_or("NONE") };
    if (p.mode != "ATTRIBUTES" && p.mode != "TRIANGLES" && p.mode != "INDICES")
        extension["mode"].fail(2331, fmt::format("there is no mode {}", excerpt(p.mode)), damaged_view);
    if (p.filter != "NONE" && p.filter != "OCTAHEDRAL" && p.filter != "QUATERNION" && p.filter != "EXPONENTIAL")
        extension["filter"].fail(2331, fmt::format("there is no filter {}", excerpt(p.filter)), damaged_view);
    if (const char* fault = fault_of(p))
        extension.fail(2331, fmt::format("has {} elements of {} bytes: {}", p.count, p.stride, fault), damaged_view);
    const std::uint64_t length = view["byteLength"].whole(), stride = view["byteStride"].whole_or(p.stride);
    if (p.count == 0 || length / p.count != p.stride || length % p.count != 0 || stride != p.stride)
        extension.fail(2331,
                       fmt::format("has {} elements of {} bytes, its buffer view {} bytes with a byteStride of {}", p.count,
                                   p.stride, length, stride),
                       damaged_view);
    return p;
}

// The highest byte of each.
std::vector<std::int8_t> exponents_of(const std::string& words)
{
    std::vector<std::int8_t> out(words.size() / 4);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<std::int8_t>(words[4 * i + 3]);
    return out;
}

int decode_rows(const Packing& p, const unsigned char* from, std::size_t size, UnpackedView& out)
{
    char* to = out.bytes.data();
    const int result = meshopt_decodeVertexBuffer(to, p.count, p.stride, from, size);
    if (result != 0) return result;
    if (p.filter == "EXPONENTIAL") out.exponents = exponents_of(out.bytes);
    if (p.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(to, p.count, p.stride);
    if (p.filter == "QUATERNION") meshopt_decodeFilterQuat(to, p.count, p.stride);
    if (p.filter == "EXPONENTIAL") meshopt_decodeFilterExp(to, p.count, p.stride);
    return 0;
}

int decode(const Packing& p, std::string_view packed, UnpackedView& out)
{
    const auto* from = reinterpret_cast<const unsigned char*>(packed.data());
    if (p.mode == "ATTRIBUTES") return decode_rows(p, from, packed.size(), out);
    char* to = out.bytes.data();
    if (p.mode == "TRIANGLES") return meshopt_decodeIndexBuffer(to, p.count, p.stride, from, packed.size());
    return meshopt_decodeIndexSequence(to, p.count, p.stride, from, packed.size());
}

} // namespace

UnpackedView decode_meshopt(const GltfValue& view, std::string_view compressed, std::uint64_t limit)
{
    const GltfValue extension = view["extensions"][meshopt_extension];
    const Packing packing = packing_of(view, extension);
    const std::uint64_t offset = extension["byteOffset"].whole_or(0), length = extension["byteLength"].whole();
    if (offset > compressed.size() || length > compressed.size() - offset)
        extension.fail(2308, fmt::format("bytes {} to {} of a buffer of {}", offset, offset + length, compressed.size()));
    const std::uint64_t unpacked = packing.count * packing.stride;
    if (unpacked / meshopt_bytes_a_byte > length || unpacked > limit)
        extension.fail(2331, fmt::format("{} bytes cannot hold the {} that its buffer view has", length, unpacked),
                       damaged_view);
    UnpackedView out { std::string(unpacked, '\0'), {} };
    const int result = decode(packing, compressed.substr(offset, length), out);
    if (result != 0)
        extension.fail(2331, fmt::format("its data cannot be decoded (meshoptimizer says {})", result), damaged_view);
    return out;
}

} // namespace pliant
