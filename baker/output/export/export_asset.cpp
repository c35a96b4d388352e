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

Json to_json(const Eigen::VectorXf& values) { return std::vector<float>(values.data(), values.data() + values.size()); }
Json to_json(const Eigen::Vector3d& v) { return { v[0], v[1], v[2] }; }

// One mesh of node 0, one scene with the nodes that have no parent.
void add_scene(Glb& glb, const std::string& name, Json mesh, bool is_skinned)
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
    }
    json["scenes"] = Json::array({ { { "nodes", roots } } });
    json["scene"] = 0;
}

// What a program that feeds the weights must know and glTF has no place for.
Json extras_of(const RuntimeBlender& blender, const MorphMesh& morph)
{
    const pliant_asset& asset = blender.asset();
    Json poses = Json::array(), names = Json::array();
    for (std::uint32_t k = 0; k < asset.pose_count; ++k) {
        const Eigen::VectorXf q
            = Eigen::Map<const Eigen::VectorXf>(pliant_asset_pose_coordinates(&asset, k), asset.dimension);
        poses.push_back({ { "name", blender.pose_name(k) }, { "weights", to_json(morph.weights(q)) } });
    }
    for (std::uint32_t j = 0; j < asset.dimension; ++j) names.push_back(fmt::format("q{}", j));
    return { { "targetNames", names },
             { "pliant",
               { { "q_min", to_json(morph.ranges.low) },
                 { "q_max", to_json(morph.ranges.high) },
                 { "poses", poses },
                 { "bounds", { { "min", to_json(morph.reachable.low) }, { "max", to_json(morph.reachable.high) } } },
                 { "normal_error_degrees",
                   { { "mean", morph.normal_error.mean_degrees }, { "worst", morph.normal_error.worst_degrees } } } } } };
}

Json morph_mesh_json(Glb& glb, const RuntimeBlender& blender, const DrawnSpace& space, const RenderScene& scene,
                     const MorphMesh& morph, const ExportOptions& options, ExportReport& report)
{
    Json primitives
        = add_primitives(glb, scene, to_float_list(morph.base), to_float_list(morph.normals.base), options, report);
    for (Eigen::Index j = 0; j < morph.deltas.cols(); ++j) {
        const std::vector<float> positions = to_float_list(morph.deltas.col(j)),
                                 normals = to_float_list(morph.normals.deltas.col(j));
        for (std::size_t i = 0; i < scene.parts.size(); ++i) {
            const ScenePart& part = scene.parts[i];
            const std::size_t position = glb.add_floats(rows_of(part, positions, 3), 3, Glb::Target::vertices, true);
            const std::size_t normal = glb.add_floats(rows_of(part, normals, 3), 3, Glb::Target::vertices);
            primitives[i]["targets"].push_back({ { "POSITION", position }, { "NORMAL", normal } });
        }
    }
    return { { "primitives", primitives },
             { "weights", to_json(morph.weights(space.first_pose)) },
             { "extras", extras_of(blender, morph) } };
}

void animate_weights(Glb& glb, const MorphMesh& morph, const Eigen::MatrixXf& path, double frames_per_second)
{
    std::vector<float> weights;
    for (Eigen::Index i = 0; i < path.cols(); ++i) {
        const std::vector<float> frame = to_float_list(morph.weights(path.col(i)));
        weights.insert(weights.end(), frame.begin(), frame.end());
    }
    const std::size_t input = add_times(glb, std::size_t(path.cols()), frames_per_second);
    const std::size_t output = glb.add_floats(weights, 1, Glb::Target::none);
    glb.json()["animations"]
        = { { { "name", "path" },
              { "samplers", { { { "input", input }, { "interpolation", "LINEAR" }, { "output", output } } } },
              { "channels", { { { "sampler", 0 }, { "target", { { "node", 0 }, { "path", "weights" } } } } } } } };
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
    if (!report.box_covers)
        warnings.push_back(warning_at(
            5203, "", "the bounding box that an engine computes from base and targets does not contain all shapes",
            "use the box in the mesh's extras (pliant.bounds), or disable culling for the mesh"));
    if (!report.has_stored_ranges)
        warnings.push_back(
            warning_at(5205, "", "the asset has no morph ranges: they were computed now and are in the mesh's extras only",
                       "bake the asset again if you need pliant_morph_weights"));
    return warnings;
}

std::vector<std::vector<float>> default_path(std::size_t pose_count, double seconds, double frames_per_second)
{
    std::vector<std::vector<float>> stops(pose_count, std::vector<float>(pose_count, 0.0f));
    for (std::size_t k = 0; k < pose_count; ++k) stops[k][k] = 1;
    stops.emplace_back(pose_count, 1 / float(pose_count));
    stops.push_back(stops[0]);
    const auto frame_count = std::size_t(std::max(1.0, std::round(seconds * frames_per_second)));
    std::vector<std::vector<float>> path;
    for (std::size_t i = 0; i <= frame_count; ++i) {
        const double at = double(i) / double(frame_count) * double(stops.size() - 1);
        const std::size_t leg = std::min(std::size_t(at), stops.size() - 2);
        const double t = at - double(leg), eased = t * t * (3 - 2 * t);
        std::vector<float> weights(pose_count);
        for (std::size_t k = 0; k < pose_count; ++k)
            weights[k] = float((1 - eased) * double(stops[leg][k]) + eased * double(stops[leg + 1][k]));
        path.push_back(weights);
    }
    return path;
}

ExportedFile export_asset(RuntimeBlender& blender, const ExportOptions& options)
{
    const pliant_asset& asset = blender.asset();
    const DrawnSpace space = drawn_space(blender);
    const RenderScene scene = exported_scene(blender, space, options.source);
    ExportedFile file;
    ExportReport& report = file.report;
    report.vertex_count = space.vertex_count();
    report.triangle_count = scene.triangles.size();
    report.part_count = scene.parts.size();
    report.image_count = scene.images.size();
    Glb glb(options.with_asset ? std::string_view(reinterpret_cast<const char*>(asset.blob), asset.blob_size)
                               : std::string_view());
    Json mesh;
    if (options.with_morph_targets) {
        const MorphMesh morph = make_morph_mesh(blender, space);
        mesh = morph_mesh_json(glb, blender, space, scene, morph, options, report);
        if (!options.path.empty())
            animate_weights(glb, morph, path_coordinates(blender, options.path), options.frames_per_second);
        report.target_count = asset.dimension;
        report.frame_count = options.path.size();
        report.diagonal = morph.reachable.diagonal();
        report.has_stored_ranges = morph.has_stored_ranges;
        report.box_covers = morph.engine_box.contains(morph.reachable);
        report.normal_error = morph.normal_error;
    } else if (options.bone_count) {
        mesh = add_skinned_mesh(glb, blender, space, scene, options, report);
    } else {
        const Eigen::VectorXd rest = space.rest();
        mesh["primitives"]
            = add_primitives(glb, scene, to_float_list(rest), to_float_list(drawn_normals(space, rest)), options, report);
    }
    if (options.with_asset) {
        mesh["extensions"] = { { "PLIANT_elastic_blend", { { "bufferView", 0 } } } };
        glb.json()["extensionsUsed"].push_back("PLIANT_elastic_blend");
    }
    add_materials(glb, scene);
    add_scene(glb, options.name, std::move(mesh), options.bone_count > 0);
    file.bytes = glb.bytes();
    return file;
}

} // namespace pliant
