// The surface that the elastic energy lives on, out of the one that files draw: seams welded, faces left out that have no
// energy.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/triangulate.h"

namespace pliant {

// By the numbers of the files: vertices that `targets` joins are one, and triangles name the one that stands for all.
struct SimulationMesh {
    std::vector<std::uint32_t> targets; // per vertex of the files
    Triangulation triangulation;        // the triangles that are left, in the order of the files, and the face of each
    SurfaceRepairs repairs;

    bool is_welded(std::uint32_t vertex) const { return targets[vertex] != vertex; }
    // The vertices that stand for these, ascending, each once.
    std::vector<std::uint32_t> joined(std::vector<std::uint32_t> vertices) const;
};

// Part of the surface (area, in any pose) that may have no area in some pose: more leaves holes in the body that nothing
// elastic spans.
constexpr double flat_part_limit = 0.1;

// `meshes`: pose 0 and others with the same faces; `drawn`: all triangles. A triangle is left out, and said in one line a
// file and kind (warnings), if its corners are not three vertices (P2201), if it has no area in some pose (P2202), or if
// another one has the same vertices (P2205). P2220 says what was welded. Error: P2221 too little of the surface is left.
SimulationMesh make_simulation_mesh(const std::vector<const MeshFile*>& meshes, const Triangulation& drawn,
                                    double weld_tolerance, DiagnosticList& diagnostics);

// "5, 7, 9, 11, 12, ...": some numbers of a longer list, for messages.
std::string first_few(const std::vector<std::uint32_t>& numbers);

} // namespace pliant
