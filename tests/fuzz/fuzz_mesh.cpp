// libFuzzer target: any bytes through one of the seven readers of meshes, which PLIANT_FUZZ_READER names, from memory. What
// a reader accepts must hold what its callers rely on.
#include "input/io/tet_builder.h"

#include <cmath>
#include <cstdlib>
#include <new>

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
    if (size == 0) return 0; // read_mesh refuses it before
    DiagnosticList diagnostics;
    const SourceFile file { "fuzz", std::string(data, data + size), &diagnostics };
    MeshFile mesh;
    try {
        if (!PLIANT_FUZZ_READER(file, mesh)) require(diagnostics.has_errors());
    } catch (const std::bad_alloc&) { // as read_mesh has it
        return 0;
    }
    for (const Diagnostic& diagnostic : diagnostics.diagnostics()) require(!to_text(diagnostic).empty());
    if (diagnostics.has_errors()) return 0;
    const std::size_t vertex_count = static_cast<std::size_t>(mesh.positions.rows());
    require(mesh.positions.allFinite());
    check_faces(mesh.faces, vertex_count);
    check_tets(mesh, vertex_count);
    return 0;
}
