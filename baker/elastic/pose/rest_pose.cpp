#include "elastic/pose/rest_pose.h"

#include "base/mesh/solid.h"
#include "input/io/encode_ply.h"
#include "input/io/read_mesh.h"
#include "input/poses/check_solid.h"

namespace pliant {

std::optional<RestPose> read_rest_pose(const std::string& path, DiagnosticList& diagnostics)
{
    std::optional<MeshFile> mesh = read_mesh(path, diagnostics);
    if (!mesh) return std::nullopt;
    if (mesh->tets.empty()) {
        diagnostics.add(
            error_at(2609, path, "is a surface: a solid of tetrahedra is expected here",
                     "give a .msh, .mesh, .veg or .vtk file; TetGen, fTetWild or Gmsh fill a surface with tetrahedra"));
        return std::nullopt;
    }
    RestPose rest;
    rest.as_read = mesh->tets;
    std::vector<MeshFile> meshes;
    meshes.push_back(std::move(*mesh));
    orient_tets(meshes, diagnostics);
    check_tets(meshes[0], check_volumes(meshes[0], nullptr, diagnostics), diagnostics);
    rest.mesh = std::move(meshes[0]);
    rest.boundary = boundary_of(rest.mesh.tets);
    return rest;
}

NormalizedPoses to_shape_set(const RestPose& rest, const std::vector<std::uint32_t>& fixed)
{
    PoseSet pose;
    pose.positions = { rest.mesh.positions };
    pose.triangles = rest.boundary;
    pose.tets = rest.mesh.tets;
    pose.regions = rest.mesh.regions;
    pose.fixed_vertices = fixed;
    return normalize(pose);
}

std::string encode_boundary(const RestPose& rest, const Positions& positions)
{
    const SolidNumbering numbering = number_boundary_first(rest.boundary, std::size_t(positions.rows()));
    Positions seen(Eigen::Index(numbering.boundary_count), 3);
    for (Eigen::Index v = 0; v < seen.rows(); ++v) seen.row(v) = positions.row(numbering.sources[std::size_t(v)]);
    std::vector<Triangle> triangles = rest.boundary;
    for (Triangle& triangle : triangles)
        for (std::uint32_t& vertex : triangle) vertex = numbering.places[vertex];
    return encode_ply(seen, to_polygons(triangles));
}

} // namespace pliant
