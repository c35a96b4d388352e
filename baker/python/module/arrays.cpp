#include "arrays.h"

#include "base/common/diagnostics.h"
#include "base/mesh/triangulate.h"
#include "input/io/source_file.h"
#include "input/io/tet_builder.h"

#include <algorithm>
#include <fmt/format.h>

namespace pliant {
namespace {

bool read_positions(const double* numbers, std::size_t vertex_count, const SourceFile& source, MeshFile& mesh)
{
    const std::size_t errors = source.diagnostics->error_count();
    mesh.positions = Eigen::Map<const Positions>(numbers, static_cast<Eigen::Index>(vertex_count), 3);
    for (std::size_t v = 0; v < vertex_count; ++v)
        for (std::size_t c = 0; c < 3; ++c)
            if (!check_coordinate(source, 0, v, numbers[3 * v + c])) break;
    return source.diagnostics->error_count() == errors;
}

void read_faces(const Array<std::int64_t, 2>& faces, const SourceFile& source, MeshFile& mesh)
{
    FaceBuilder builder(source, mesh);
    const auto vertex_count = static_cast<std::uint64_t>(mesh.positions.rows());
    for (std::size_t f = 0; f < faces.shape(0); ++f) {
        for (std::size_t c = 0; c < faces.shape(1); ++c) builder.add_corner(0, faces(f, c), vertex_count);
        builder.end_face(0);
    }
}

void read_tets(const Array<std::int64_t, 2>& tets, const SourceFile& source, MeshFile& mesh)
{
    TetBuilder builder(source, mesh);
    for (std::size_t t = 0; t < tets.shape(0); ++t) builder.add(0, { tets(t, 0), tets(t, 1), tets(t, 2), tets(t, 3) });
    builder.finish();
}

// Counts before any memory is taken; an array of n cells holds them all, so only the limits of the format can be passed.
void check_counts(std::size_t vertex_count, std::size_t cell_count, std::size_t corner_count, DiagnosticList& diagnostics)
{
    check_count({ "poses", "", &diagnostics }, 0, "vertex", vertex_count, vertex_count_limit, vertex_count, 1);
    check_count({ "faces", "", &diagnostics }, 0, "face", cell_count, face_count_limit, cell_count, 1);
    check_count({ "faces", "", &diagnostics }, 0, "corner", corner_count, corner_count_limit, corner_count, 1);
}

} // namespace

SourcePoses poses_of_arrays(const Array<double, 3>& positions, const std::optional<Array<std::int64_t, 2>>& faces,
                            const std::optional<Array<std::int64_t, 2>>& tets, const std::vector<std::string>& names,
                            const std::string& label)
{
    DiagnosticList diagnostics;
    const std::size_t pose_count = positions.shape(0), vertex_count = positions.shape(1);
    const Array<std::int64_t, 2>& cells = tets ? *tets : faces.value();
    check_counts(vertex_count, cells.shape(0), cells.size(), diagnostics);
    SourcePoses out;
    for (std::size_t k = 0; k < pose_count && !diagnostics.has_errors(); ++k) {
        MeshFile& mesh = out.meshes.emplace_back();
        mesh.path = fmt::format("{}[{}]", label, k);
        mesh.name = names.at(k);
        read_positions(positions.data() + 3 * vertex_count * k, vertex_count, { mesh.path, "", &diagnostics }, mesh);
        if (k > 0) {
            mesh.faces = out.meshes[0].faces;
            mesh.tets = out.meshes[0].tets;
        } else if (tets) {
            read_tets(*tets, { "tets", "", &diagnostics }, mesh);
        } else {
            read_faces(*faces, { "faces", "", &diagnostics }, mesh);
        }
    }
    if (diagnostics.has_errors()) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    return out;
}

nb::object faces_to_numpy(const Polygons& faces)
{
    const std::size_t corners = faces.count() ? faces.size(0) : 3;
    bool is_uniform = true;
    for (std::size_t f = 0; f < faces.count(); ++f) is_uniform = is_uniform && faces.size(f) == corners;
    if (is_uniform) return to_numpy(faces.indices, { faces.count(), corners });
    const std::vector<Triangle> triangles = triangulate(faces).triangles;
    std::vector<std::uint32_t> flat;
    for (const Triangle& triangle : triangles) flat.insert(flat.end(), triangle.begin(), triangle.end());
    return to_numpy(std::move(flat), { triangles.size(), 3 });
}

} // namespace pliant
