// Buffer views compressed by EXT_meshopt_compression, through meshoptimizer's own decoder.
#pragma once

#include "input/gltf/value.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace pliant {

constexpr const char* meshopt_extension = "EXT_meshopt_compression";

// The codecs write at least one bit for eight bytes, so that no small file can ask for much memory.
constexpr std::uint64_t meshopt_bytes_a_byte = 64;

struct UnpackedView {
    std::string bytes;
    // Of the filter EXPONENTIAL, else none: its floats are whole numbers times 2 to the power of these.
    std::vector<std::int8_t> exponents;
};

// What a view holds that has the extension. `compressed` is the buffer that the extension names, `limit` the bytes that
// may come out. Everything that the extension asks for is checked before the decoder sees the data. Throws Failure: P2331,
// P2306, P2308.
UnpackedView decode_meshopt(const GltfValue& view, std::string_view compressed, std::uint64_t limit);

} // namespace pliant
