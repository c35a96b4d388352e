// libFuzzer target: any bytes as a mesh file of the extension of PLIANT_FUZZ_PATH, from memory. A mesh that is accepted must
// hold what its callers rely on.
#include "input/io/read_mesh.h"

#include <cstdlib>

using namespace pliant;

namespace {

void require(bool condition)
{
    if (!condition) std::abort();
}

void check_faces(const Polygons& faces, std::size_t vertex_count)
{
    require(!faces.offsets.empty() && faces.offsets[0] == 0 && faces.offsets.back() == faces.indices.size());
    for (std::size_t f = 0; f < faces.count(); ++f) require(faces.offsets[f] + 3 <= faces.offsets[f + 1]);
    for (const std::uint32_t v : faces.indices) require(v < vertex_count);
}

void check_tets(const MeshFile& mesh, std::size_t vertex_count)
{
    for (const Tetrahedron& tet : mesh.tets)
        for (const std::uint32_t v : tet) require(v < vertex_count);
    const SolidRegions& regions = mesh.regions;
    require(regions.of_tet.empty() || regions.of_tet.size() == mesh.tets.size());
    for (const std::uint32_t m : regions.of_tet) require(m < regions.materials.size());
    require(mesh.tet_lines.empty() || mesh.tet_lines.size() == mesh.tets.size());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    DiagnosticList diagnostics;
    const std::optional<MeshFile> mesh = parse_mesh(PLIANT_FUZZ_PATH, std::string(data, data + size), diagnostics);
    for (const Diagnostic& diagnostic : diagnostics.diagnostics()) require(!to_text(diagnostic).empty());
    require(mesh.has_value() != diagnostics.has_errors());
    if (!mesh) return 0;
    const std::size_t vertex_count = static_cast<std::size_t>(mesh->positions.rows());
    require(vertex_count > 0 && mesh->positions.allFinite());
    check_faces(mesh->faces, vertex_count);
    check_tets(*mesh, vertex_count);
    return 0;
}
