#include "input/poses/load_render_mesh.h"

#include "base/mesh/surface.h"
#include "base/mesh/triangulate.h"
#include "input/io/read_mesh.h"
#include "input/poses/check_surface.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace pliant {
namespace {

// Parts of the bounding-box diagonal of pose 0.
constexpr double outside_limit = 0.05, outside_warned = 0.005;
constexpr double outside_counted = 1e-6; // nearer is rounding of the files

// Smallest area that counts, of a surface in the unit box.
constexpr double least_area = 1e-12;

void check_is_surface(const MeshFile& mesh, const std::vector<Triangle>& triangles)
{
    std::string what;
    if (!mesh.tets.empty()) {
        what = "is a solid of tetrahedra: a surface is expected here";
    } else {
        const Positions unit = to_unit_box(mesh.positions);
        const Shape shape = Eigen::Map<const Shape>(unit.data(), unit.size());
        if (!(triangle_areas(shape, triangles).maxCoeff() > least_area)) what = "has no triangle with area";
    }
    if (!what.empty())
        throw Failure(ExitCode::bad_input, error_at(2608, mesh.path, what, "give the render mesh as .obj, .ply or .off"));
}

[[noreturn]] void refuse_far(const MeshFile& mesh, const PoseSet& poses, const Embedding& embedding)
{
    Eigen::Index count = 0, first = 0;
    for (Eigen::Index v = embedding.distances.size() - 1; v >= 0; --v) {
        if (std::isfinite(embedding.distances[v])) continue;
        ++count;
        first = v;
    }
    const double distance
        = embed(mesh.positions.row(first), poses.positions[0], poses.tets, std::numeric_limits<double>::infinity())
              .distances[0];
    throw Failure(
        ExitCode::bad_input,
        error_at(
            2606, mesh.path,
            fmt::format("vertex {} lies {:.3g} outside {}: {:.3g} % of its diagonal, {:.0f} % allowed{}", first, distance,
                        poses.paths[0], 100 * distance / box_diagonal(poses.positions[0]), 100 * outside_limit,
                        count > 1 ? fmt::format(" ({} vertices are too far)", count) : ""),
            "the surface must lie at the place of the first pose, in the same units; or mesh a larger solid around it"));
}

// Of poses loading checks them.
void warn_of_polygons(const MeshFile& mesh, const Triangulation& triangulation, std::vector<Diagnostic>* warnings)
{
    if (!warnings) return;
    DiagnosticList found;
    check_polygons(mesh, triangulation, found);
    for (Diagnostic& warning : found.diagnostics()) warnings->push_back(std::move(warning));
}

void require_solid(const PoseSet& poses)
{
    if (!poses.is_solid())
        throw Failure(ExitCode::usage,
                      error_at(1209, "", "--surface is for solids, the poses are surfaces",
                               "leave it out: a surface is its own render mesh"));
}

} // namespace

RenderMesh load_render_mesh(const std::string& path, const PoseSet& poses, std::vector<Diagnostic>* warnings)
{
    require_solid(poses); // before the file is read
    return embed_render_mesh(read_mesh(path), poses, warnings);
}

RenderMesh embed_render_mesh(MeshFile mesh, const PoseSet& poses, std::vector<Diagnostic>* warnings)
{
    require_solid(poses);
    RenderMesh surface;
    Triangulation triangulation = triangulate(mesh.faces);
    check_is_surface(mesh, triangulation.triangles);
    warn_of_polygons(mesh, triangulation, warnings);
    surface.triangles = std::move(triangulation.triangles);
    const double size = box_diagonal(poses.positions[0]);
    surface.embedding = embed(mesh.positions, poses.positions[0], poses.tets, outside_limit * size);
    const Eigen::VectorXd& distances = surface.embedding.distances;
    if (!distances.allFinite()) refuse_far(mesh, poses, surface.embedding);
    surface.outside_count = std::size_t((distances.array() > outside_counted * size).count());
    surface.farthest_outside = distances.maxCoeff() / size;
    surface.largest_weight = surface.embedding.weights.cwiseAbs().maxCoeff();
    const auto warned_count = (distances.array() > outside_warned * size).count();
    if (warned_count && warnings)
        warnings->push_back(
            warning_at(2607, mesh.path,
                       fmt::format("{} vertices lie more than {:.1f} % of the diagonal outside {}, the farthest {:.2f} %",
                                   warned_count, 100 * outside_warned, poses.paths[0], 100 * surface.farthest_outside),
                       "their motion is extrapolated from the nearest tetrahedron; a larger solid around them is safer"));
    surface.polygons = std::move(mesh.faces);
    return surface;
}

} // namespace pliant
