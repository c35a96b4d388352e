#include "input/poses/load_poses.h"

#include "base/mesh/render_mesh.h"
#include "base/mesh/solid.h"
#include "input/gltf/document.h"
#include "input/poses/check_connectivity.h"
#include "input/poses/check_solid.h"
#include "input/poses/check_surface.h"
#include "input/poses/compare_poses.h"
#include "input/poses/fixed_vertices.h"
#include "input/poses/pose_source.h"
#include "input/poses/simulation_mesh.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <set>
#include <utility>

namespace pliant {
namespace {

// What the checks found out on the way.
struct Checked {
    Triangulation triangulation;      // what is drawn and, of a solid, compared: of that its boundary
    SimulationMesh surface;           // of surfaces
    std::vector<std::uint32_t> fixed; // by the numbers of the files
};

// Every pose on its own and against pose 0, as far as the earlier diagnostics leave a meaning to the later questions. True
// if all poses show the same mesh.
bool check_surfaces(const std::vector<MeshFile>& meshes, double weld_tolerance, Checked& checked,
                    DiagnosticList& diagnostics)
{
    const MeshFile& first = meshes[0];
    std::vector<const MeshFile*> alike = { &first };
    for (std::size_t k = 1; k < meshes.size(); ++k)
        if (check_same_kind(first, meshes[k], diagnostics) && check_same_faces(first, meshes[k], diagnostics))
            alike.push_back(&meshes[k]);
    for (const MeshFile* mesh : alike) check_shape(*mesh, checked.triangulation, diagnostics);
    checked.surface = make_simulation_mesh(alike, checked.triangulation, weld_tolerance, diagnostics);
    if (checked.surface.triangulation.triangles.empty()) return false; // said; nothing to look at
    check_connectivity(first, checked.surface, diagnostics);
    for (std::size_t k = 1; k < alike.size(); ++k)
        check_correspondence(first, *alike[k], checked.surface.triangulation, diagnostics);
    return alike.size() == meshes.size();
}

// The same for solids.
bool check_solids(const std::vector<MeshFile>& meshes, const Triangulation& boundary, DiagnosticList& diagnostics)
{
    const MeshFile& first = meshes[0];
    check_tets(first, check_volumes(first, nullptr, diagnostics), diagnostics);
    check_stiffness(first, diagnostics);
    bool is_comparable = true;
    for (std::size_t k = 1; k < meshes.size(); ++k) {
        if (!check_same_kind(first, meshes[k], diagnostics) || !check_same_tets(first, meshes[k], diagnostics)) {
            is_comparable = false;
            continue;
        }
        check_same_materials(first, meshes[k], diagnostics);
        check_volumes(meshes[k], &first, diagnostics);
        check_correspondence(first, meshes[k], boundary, diagnostics);
    }
    return is_comparable;
}

// The faces that are drawn and compared: of a solid those of its boundary.
Triangulation triangulate(const MeshFile& mesh)
{
    return triangulate(mesh.tets.empty() ? mesh.faces : to_polygons(boundary_of(mesh.tets)));
}

// From the numbering of the files to that of PoseSet.
void renumber(PoseSet& poses)
{
    const SolidNumbering numbering = number_boundary_first(poses.triangles, poses.vertex_count());
    const auto place = [&](std::uint32_t& vertex) { vertex = numbering.places[vertex]; };
    for (Positions& positions : poses.positions) {
        const Positions old = positions;
        for (std::size_t v = 0; v < numbering.sources.size(); ++v)
            positions.row(static_cast<Eigen::Index>(v)) = old.row(numbering.sources[v]);
    }
    for (Triangle& triangle : poses.triangles) std::for_each(triangle.begin(), triangle.end(), place);
    for (Tetrahedron& tet : poses.tets) std::for_each(tet.begin(), tet.end(), place);
    std::for_each(poses.fixed_vertices.begin(), poses.fixed_vertices.end(), place);
    std::sort(poses.fixed_vertices.begin(), poses.fixed_vertices.end());
    poses.polygons = to_polygons(poses.triangles);
    poses.source_vertices = numbering.sources;
    poses.boundary_vertex_count = numbering.boundary_count;
}

// From the vertices of the files to those of the elastic surface; the former are drawn where they differ.
void take_elastic(PoseSet& poses, Triangulation drawn, SimulationMesh surface)
{
    poses.repairs = surface.repairs;
    poses.triangles = std::move(surface.triangulation.triangles);
    if (poses.repairs.welded_count == 0 && poses.repairs.left_out_count() == 0) return;
    std::vector<std::uint32_t> places(surface.targets.size()), sources;
    for (std::uint32_t v = 0; v < places.size(); ++v) {
        if (surface.is_welded(v)) continue;
        places[v] = static_cast<std::uint32_t>(sources.size());
        sources.push_back(v);
    }
    for (std::uint32_t v = 0; v < places.size(); ++v) places[v] = places[surface.targets[v]];
    poses.render_mesh = copy_to_render_mesh(poses.polygons, std::move(drawn.triangles), places);
    for (Triangle& triangle : poses.triangles)
        for (std::uint32_t& vertex : triangle) vertex = places[vertex];
    poses.fixed_vertices = surface.joined(poses.fixed_vertices);
    for (std::uint32_t& vertex : poses.fixed_vertices) vertex = places[vertex]; // ascending still
    if (sources.size() == places.size()) return;
    for (Positions& positions : poses.positions) {
        const Positions in_files = positions;
        positions.resize(static_cast<Eigen::Index>(sources.size()), 3);
        for (std::size_t v = 0; v < sources.size(); ++v)
            positions.row(static_cast<Eigen::Index>(v)) = in_files.row(sources[v]);
    }
    poses.source_vertices = std::move(sources);
}

// What tells files of one name apart: of a glTF file its own name, else that of its folder.
std::string origin_of(const MeshFile& mesh)
{
    const std::filesystem::path path = split_pose_argument(mesh.path).path;
    return is_gltf_name(path.string()) ? path.stem().string() : path.parent_path().filename().string();
}

// Weights are set by name, so no two poses have the same: "run/rest" and "walk/rest", else "rest" and "rest (2)".
std::vector<std::string> unique_names(const std::vector<MeshFile>& meshes)
{
    std::map<std::string, std::size_t> counts;
    for (const MeshFile& mesh : meshes) ++counts[pose_name(mesh)];
    std::vector<std::string> names;
    std::set<std::string> taken;
    for (const MeshFile& mesh : meshes) {
        std::string name = pose_name(mesh);
        const std::string origin = counts[name] > 1 ? origin_of(mesh) : "";
        if (!origin.empty()) name = origin + "/" + name;
        names.push_back(name);
        for (int k = 2; !taken.insert(names.back()).second; ++k) names.back() = fmt::format("{} ({})", name, k);
    }
    return names;
}

PoseSet to_pose_set(std::vector<MeshFile> meshes, Checked checked)
{
    PoseSet poses;
    poses.names = unique_names(meshes);
    for (MeshFile& mesh : meshes) {
        poses.paths.push_back(std::move(mesh.path));
        poses.positions.push_back(std::move(mesh.positions));
        poses.initial_weights.push_back(mesh.initial_weight);
    }
    poses.polygons = std::move(meshes[0].faces);
    poses.tets = std::move(meshes[0].tets);
    poses.regions = std::move(meshes[0].regions);
    poses.fixed_vertices = std::move(checked.fixed);
    poses.scene = std::move(meshes[0].scene);
    if (poses.is_solid()) {
        poses.triangles = std::move(checked.triangulation.triangles);
        renumber(poses);
    } else {
        take_elastic(poses, std::move(checked.triangulation), std::move(checked.surface));
    }
    pin_vertices(poses.fixed_vertices, poses.positions);
    return poses;
}

// Whether single precision holds the squares of lengths, as it must of normals.
bool check_sizes(const std::vector<MeshFile>& meshes, DiagnosticList& diagnostics)
{
    constexpr double least_size = 1e-15;
    const std::size_t errors_before = diagnostics.error_count();
    for (const MeshFile& mesh : meshes) {
        const double size = (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).maxCoeff();
        if (size > 0 && size < least_size)
            diagnostics.add(error_at(2120, mesh.path, fmt::format("is {:.3g} wide, less than {:g}", size, least_size),
                                     "use a smaller unit of length"));
    }
    return diagnostics.error_count() == errors_before;
}

// The checks of what was read; the fixed vertices.
Checked check_all(std::vector<MeshFile>& meshes, Blend blend, const LoadOptions& options, DiagnosticList& diagnostics)
{
    if (!check_sizes(meshes, diagnostics)) return {};
    const bool is_solid = !meshes[0].tets.empty();
    if (is_solid) orient_tets(meshes, diagnostics);
    Checked checked;
    checked.triangulation = triangulate(meshes[0]);
    const bool is_comparable = is_solid ? check_solids(meshes, checked.triangulation, diagnostics)
                                        : check_surfaces(meshes, options.weld_tolerance, checked, diagnostics);
    const std::size_t vertex_count = static_cast<std::size_t>(meshes[0].positions.rows());
    std::vector<std::uint32_t>& fixed = checked.fixed;
    for (const std::uint32_t v : options.fixed_vertices)
        if (v < vertex_count) fixed.push_back(v); // others belong to another mesh, as will be found out
    const bool has_fixed = !options.fixed_path.empty() || !fixed.empty();
    const std::string& name = options.fixed_path.empty() ? options.fixed_name : options.fixed_path;
    const std::size_t errors_before = diagnostics.error_count();
    if (!options.fixed_path.empty()) fixed = read_fixed_vertices(options.fixed_path, vertex_count, diagnostics);
    if (!name.empty() && is_comparable && diagnostics.error_count() == errors_before)
        check_fixed_vertices(name, is_solid ? fixed : checked.surface.joined(fixed),
                             vertex_count - checked.surface.repairs.welded_count, meshes, diagnostics);
    if (is_comparable && meshes.size() > 1)
        check_distinct(meshes, is_solid ? checked.triangulation : checked.surface.triangulation,
                       blend == Blend::average && options.align && !options.share_frame && !has_fixed, diagnostics);
    return checked;
}

// `has_first`: the first of the meshes is the first pose; else it could not be read, and the diagnostics say why.
PoseSet finish(std::vector<MeshFile> meshes, bool has_first, Blend blend, const LoadOptions& options,
               DiagnosticList& diagnostics, std::vector<Diagnostic>* warnings)
{
    Checked checked;
    if (has_first) checked = check_all(meshes, blend, options, diagnostics);
    if (diagnostics.has_errors()) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    if (warnings) {
        const std::vector<Diagnostic> found = diagnostics.diagnostics();
        warnings->insert(warnings->end(), found.begin(), found.end());
    }
    PoseSet poses = to_pose_set(std::move(meshes), std::move(checked));
    poses.blend = blend;
    poses.share_frame = options.share_frame;
    return poses;
}

} // namespace

std::string pose_name(const MeshFile& mesh)
{
    return mesh.name.empty() ? std::filesystem::path(mesh.path).stem().string() : mesh.name;
}

PoseSet load_poses(const std::vector<std::string>& paths, const LoadOptions& options, std::vector<Diagnostic>* warnings)
{
    DiagnosticList diagnostics(options.lines_per_number);
    PoseSources read = read_pose_sources(paths, options.blend, diagnostics);
    LoadOptions placed = options;
    placed.share_frame = read.share_frame;
    return finish(std::move(read.meshes), read.has_first, read.blend, placed, diagnostics, warnings);
}

PoseSet check_poses(std::vector<MeshFile> meshes, const LoadOptions& options, std::vector<Diagnostic>* warnings)
{
    DiagnosticList diagnostics(options.lines_per_number);
    return finish(std::move(meshes), true, options.blend.value_or(Blend::average), options, diagnostics, warnings);
}

} // namespace pliant
