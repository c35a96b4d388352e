#include "output/export/compress_view.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <meshoptimizer.h>
#include <vector>

namespace pliant {

std::string compress_rows(std::string_view bytes, std::size_t stride)
{
    meshopt_encodeVertexVersion(0); // the one of the extension
    const std::size_t count = bytes.size() / stride;
    std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(count, stride));
    packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), bytes.data(), count, stride));
    return { packed.begin(), packed.end() };
}

std::string compress_triangles(std::string_view bytes, std::size_t stride)
{
    meshopt_encodeIndexVersion(1); // the one of the extension
    std::vector<unsigned int> corners(bytes.size() / stride);
    for (std::size_t i = 0; i < corners.size(); ++i) std::memcpy(&corners[i], &bytes[i * stride], stride);
    const std::size_t vertex_count = corners.empty() ? 0 : 1 + *std::max_element(corners.begin(), corners.end());
    std::vector<unsigned char> packed(meshopt_encodeIndexBufferBound(corners.size(), vertex_count));
    packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), corners.data(), corners.size()));
    return { packed.begin(), packed.end() };
}

} // namespace pliant
