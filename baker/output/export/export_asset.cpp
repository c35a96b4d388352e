#include "output/export/export_asset.h"

#include "output/export/export_parts.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

namespace pliant {

namespace {

using Json = Glb::Json;

// Above this number engines that can be met refuse morph targets.
constexpr std::size_t many_targets = 64;
constexpr double visible_error = 0.01; // of the diagonal

// One mesh of node 0, one scene with the nodes that have no parent. The node of a skin has no place of its own.
void add_scene(Glb& glb, const std::string& name, Json mesh, bool is_skinned, const Grid& grid)
{
    Json& json = glb.json();
    mesh["name"] = name;
    json["meshes"] = Json::array({ std::move(mesh) });
    if (!is_skinned) json["nodes"] = Json::array({ Json::object() });
    json["nodes"][0] = { { "name", name }, { "mesh", 0 } };
    Json roots = Json::array({ 0 });
    if (is_skinned) {
        json["nodes"][0]["skin"] = 0;
        roots.push_back(1);
    } else if (grid.step > 0) {
        json["nodes"][0]["translation"] = { grid.origin[0], grid.origin[1], grid.origin[2] };
        json["nodes"][0]["scale"] = { grid.step, grid.step, grid.step };
    }
    json["scenes"] = Json::array({ { { "nodes", roots } } });
    json["scene"] = 0;
}

std::vector<Weights> stops_at_poses(const WeightDomain& domain)
{
    std::vector<Weights> stops;
    for (std::size_t k = 0; k < domain.size(); ++k) stops.push_back(corner_weights(domain.size(), k));
    stops.push_back(domain.centre());
    stops.push_back(stops[0]);
    return stops;
}

std::vector<Weights> stops_at_layers(const WeightDomain& domain)
{
    std::vector<Weights> stops = { domain.centre() };
    Weights all = domain.centre();
    for (std::size_t k = 0; k < domain.size(); ++k) {
        const Weights full = domain.full(k) * corner_weights(domain.size(), k);
        if (k < sparse_limit) all += full;
        stops.push_back(full);
        stops.push_back(domain.centre());
    }
    stops.push_back(all);
    stops.push_back(domain.centre());
    return stops;
}

// The shape of pose 0, and nothing that moves it.
Json add_still_mesh(Glb& glb, const DrawnSpace& space, const RenderScene& scene, const ExportOptions& options,
                    ExportReport& report, Grid& grid)
{
    return { { "primitives", add_primitives(glb, scene, stored_rest(space, options, report, grid), {}) } };
}

[[noreturn]] void refuse_size(const std::string& path, const std::string& what, std::uint64_t limit, const std::string& hint)
{
    throw Failure(
        ExitCode::bad_input,
        error_at(5102, path, fmt::format("not a usable asset: {}, the limit for its size is {}", what, limit), hint));
}

// Each part has its own targets, and a hostile asset can have a part for each vertex.
void require_few_targets(const pliant_asset& asset, const RenderScene& scene, const std::string& path)
{
    const std::uint64_t limit = 32768 + asset.blob_size / 32, count = std::uint64_t(scene.parts.size()) * asset.dimension;
    if (count > limit)
        refuse_size(path,
                    fmt::format("its {} parts in {} dimensions are {} targets", scene.parts.size(), asset.dimension, count),
                    limit, "bake it again with fewer materials and meshes, or with --no-scene");
}

// An honest basis has half a byte for each number of a column, and little for vertices that are still.
void require_few_numbers(const pliant_asset& asset, const std::string& path)
{
    const std::uint64_t limit = 16000000 + 16 * asset.blob_size,
                        count = std::uint64_t(3) * asset.boundary_vertex_count * asset.dimension;
    if (count > limit)
        refuse_size(path,
                    fmt::format("the columns of its {} vertices in {} dimensions are {} numbers",
                                asset.boundary_vertex_count, asset.dimension, count),
                    limit, "bake it again with a smaller --dim");
}

} // namespace

Eigen::MatrixXf path_coordinates(RuntimeBlender& blender, const std::vector<std::vector<float>>& path)
{
    Eigen::MatrixXf all(blender.asset().dimension, Eigen::Index(path.size()));
    for (std::size_t i = 0; i < path.size(); ++i) {
        const std::vector<float> q = blender.solve(path[i], i != 0);
        all.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size()));
    }
    return all;
}

StoredVertices stored_rest(const DrawnSpace& space, const ExportOptions& options, ExportReport& report, Grid& grid)
{
    StoredVertices out;
    out.positions = space.rest();
    if (options.with_normals) out.normals = drawn_normals(space, out.positions);
    if (!(options.quantisation_error > 0)) return out;
    grid = grid_for(out.positions, options.quantisation_error);
    report.position_error = round_to(grid, out.positions);
    out.normals = (127 * out.normals).array().round();
    out.is_whole = true;
    return out;
}

std::size_t add_times(Glb& glb, std::size_t count, double frames_per_second)
{
    std::vector<float> times(count);
    for (std::size_t i = 0; i < count; ++i) times[i] = float(double(i) / frames_per_second);
    return glb.add_floats(times, 1, Glb::Target::none, true);
}

std::vector<Diagnostic> warnings_about(const ExportReport& report)
{
    std::vector<Diagnostic> warnings;
    if (report.target_count == 0) return warnings;
    if (report.target_count > many_targets)
        warnings.push_back(warning_at(
            5202, "", fmt::format("{} morph targets: some engines support {} only", report.target_count, many_targets),
            "bake with --dim 64 or less for Bevy before 0.18; Filament and Bevy support 256, three.js any number"));
    if (!report.has_stored_ranges)
        warnings.push_back(
            warning_at(5205, "", "the asset has no morph ranges: they were computed now and are in the mesh's extras only",
                       "bake the asset again if you need pliant_morph_weights"));
    if (report.table_largest > visible_error)
        warnings.push_back(
            warning_at(5208, "",
                       fmt::format("the table of weights for engines is off by up to {:.1f} % of the diagonal between its "
                                   "centres (mean {:.2f} %)",
                                   100 * report.table_largest, 100 * report.table_mean),
                       "the animation does not use it; where weights change in the engine, compute q with the runtime "
                       "(--embed)"));
    return warnings;
}

std::vector<std::vector<float>> default_path(const WeightDomain& domain, double seconds, double frames_per_second)
{
    const std::vector<Weights> stops = domain.is_box() ? stops_at_layers(domain) : stops_at_poses(domain);
    const auto frame_count = std::size_t(std::max(1.0, std::round(seconds * frames_per_second)));
    std::vector<std::vector<float>> path;
    for (std::size_t i = 0; i <= frame_count; ++i) {
        const double at = double(i) / double(frame_count) * double(stops.size() - 1);
        const std::size_t leg = std::min(std::size_t(at), stops.size() - 2);
        const double t = at - double(leg), eased = t * t * (3 - 2 * t);
        const Eigen::VectorXf weights = ((1 - eased) * stops[leg] + eased * stops[leg + 1]).cast<float>();
        path.push_back(to_float_list(weights));
    }
    return path;
}

ExportedFile export_asset(RuntimeBlender& blender, const ExportOptions& options)
{
    const pliant_asset& asset = blender.asset();
    require_few_numbers(asset, options.source);
    const DrawnSpace space = drawn_space(blender, options.source);
    const RenderScene scene = exported_scene(blender, space, options.source);
    require_few_targets(asset, scene, options.source);
    ExportedFile file;
    ExportReport& report = file.report;
    report.vertex_count = space.vertex_count();
    report.triangle_count = scene.triangles.size();
    report.part_count = scene.parts.size();
    report.image_count = scene.images.size();
    Glb glb(options.with_asset ? std::string_view(reinterpret_cast<const char*>(asset.blob), asset.blob_size)
                               : std::string_view(),
            options.with_compression);
    Grid grid;
    Json mesh = options.with_morph_targets ? add_morph_mesh(glb, blender, space, scene, options, report, grid)
        : options.bone_count               ? add_skinned_mesh(glb, blender, space, scene, options, report, grid)
                                           : add_still_mesh(glb, space, scene, options, report, grid);
    if (options.with_asset) {
        mesh["extensions"] = { { "PLIANT_elastic_blend", { { "bufferView", 0 } } } };
        glb.use_extension("PLIANT_elastic_blend", false);
    }
    add_materials(glb, scene);
    add_scene(glb, options.name, std::move(mesh), options.bone_count > 0, grid);
    file.bytes = glb.bytes();
    return file;
}

} // namespace pliant
