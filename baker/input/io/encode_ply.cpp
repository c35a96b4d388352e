#include "input/io/encode_ply.h"

#include "base/mesh/render_mesh.h"

#include <cstring>
#include <fmt/format.h>

namespace pliant {
namespace {

void append_little_endian(std::string& bytes, std::uint32_t value)
{
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xff);
}

bool has_large_face(const Polygons& faces)
{
    for (std::size_t face = 0; face < faces.count(); ++face) {
        if (faces.size(face) > 255) return true;
    }
    return false;
}

} // namespace

std::string encode_ply(const float* positions, std::size_t vertex_count, const Polygons& faces)
{
    const bool is_wide = has_large_face(faces);
    std::string bytes = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
                                    "property float x\nproperty float y\nproperty float z\n"
                                    "element face {}\nproperty list {} int vertex_indices\nend_header\n",
                                    vertex_count, faces.count(), is_wide ? "uint" : "uchar");
    bytes.reserve(bytes.size() + 12 * vertex_count + (is_wide ? 4 : 1) * faces.count() + 4 * faces.indices.size());
    for (std::size_t i = 0; i < 3 * vertex_count; ++i) {
        std::uint32_t bits;
        std::memcpy(&bits, &positions[i], sizeof bits);
        append_little_endian(bytes, bits);
    }
    for (std::size_t face = 0; face < faces.count(); ++face) {
        if (is_wide)
            append_little_endian(bytes, static_cast<std::uint32_t>(faces.size(face)));
        else
            bytes += static_cast<char>(faces.size(face));
        for (std::uint32_t i = faces.offsets[face]; i < faces.offsets[face + 1]; ++i)
            append_little_endian(bytes, faces.indices[i]);
    }
    return bytes;
}

std::string encode_ply(const Positions& positions, const Polygons& faces)
{
    const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> rounded = positions.cast<float>();
    return encode_ply(rounded.data(), static_cast<std::size_t>(rounded.rows()), faces);
}

std::string encode_ply(const Positions& positions, const Polygons& faces, const VertexNumbers& numbers, bool all_vertices)
{
    if (numbers.sources.empty()) return encode_ply(positions, faces);
    if (!all_vertices)
        return encode_ply(Positions(positions.topRows(static_cast<Eigen::Index>(numbers.boundary_count))), faces);
    Positions in_file_order = Positions::Zero(positions.rows(), 3);
    Polygons renumbered = faces;
    for (std::size_t v = 0; v < numbers.sources.size(); ++v)
        in_file_order.row(numbers.sources[v]) = positions.row(static_cast<Eigen::Index>(v));
    for (std::uint32_t& vertex : renumbered.indices) vertex = numbers.sources[vertex];
    return encode_ply(in_file_order, renumbered);
}

std::string encode_ply(const Positions& positions, const PoseSet& poses, bool all_vertices)
{
    if (poses.render_mesh) return encode_ply(render_mesh_positions(*poses.render_mesh, positions), poses.polygons);
    return encode_ply(positions, poses.polygons, { poses.source_vertices, poses.boundary_vertex_count }, all_vertices);
}

} // namespace pliant
