#include "output/export/export_parts.h"
#include "output/export/grid_mesh.h"
#include "output/export/pose_table.h"

#include <fmt/core.h>

namespace pliant {

namespace {

using Json = Glb::Json;

Json to_json(const Eigen::VectorXf& values) { return std::vector<float>(values.data(), values.data() + values.size()); }
Json to_json(const Eigen::Vector3d& v) { return { v[0], v[1], v[2] }; }

Json poses_json(const RuntimeBlender& blender, const MorphMesh& morph)
{
    const pliant_asset& asset = blender.asset();
    Json poses = Json::array();
    for (std::uint32_t k = 0; k < asset.pose_count; ++k)
        poses.push_back({ { "name", blender.pose_name(k) }, { "weights", to_float_list(morph.poses.col(k)) } });
    return poses;
}

// Flat lists: Blender keeps no others as custom properties.
Json table_json(const PoseTable& table)
{
    Json centres = Json::array(), coefficients = Json::array();
    for (const Weights& centre : table.function.centres)
        for (const double x : centre) centres.push_back(x);
    for (const auto& row : table.function.coefficients.rowwise())
        for (const double x : row) coefficients.push_back(x);
    return { { "kernel", "cubic" },
             { "centres", centres },
             { "coefficients", coefficients },
             { "error_of_diagonal", { { "mean", table.mean_error }, { "largest", table.largest_error } } } };
}

Json layers_json(const WeightDomain& domain, const RuntimeBlender& blender)
{
    Json layers = Json::array();
    for (std::size_t k = 0; k < domain.size(); ++k) {
        const WeightRange& range = domain.ranges()[k];
        layers.push_back({ { "name", blender.pose_name(std::uint32_t(k) + 1) },
                           { "low", range.low },
                           { "high", range.high },
                           { "initial", range.initial } });
    }
    return layers;
}

// What a program that feeds the weights must know and glTF has no place for.
Json extras_of_mesh(const RuntimeBlender& blender, const MorphMesh& morph, const PoseTable& table,
                    const ExportReport& report)
{
    Json names = Json::array();
    for (Eigen::Index j = 0; j < morph.deltas.cols(); ++j) names.push_back(fmt::format("q{}", j));
    Json ours = { { "q_min", to_json(morph.ranges.low) },
                  { "q_max", to_json(morph.ranges.high) },
                  { "poses", poses_json(blender, morph) },
                  { "bounds", { { "min", to_json(morph.reachable.low) }, { "max", to_json(morph.reachable.high) } } } };
    if (morph.normals.base.size())
        ours["normal_error_degrees"]
            = { { "mean", report.normal_error.mean_degrees }, { "worst", report.normal_error.worst_degrees } };
    if (report.position_error > 0) ours["position_error_of_diagonal"] = { { "largest", report.position_error } };
    if (const WeightDomain domain = blender.domain(); domain.is_box()) {
        ours["blend"] = "layers";
        ours["layers"] = layers_json(domain, blender);
    }
    ours["pose_table"] = table_json(table);
    return { { "targetNames", names }, { "pliant", std::move(ours) } };
}

// Target j, or the base where j is the number of targets.
StoredVertices stored_column(const MorphMesh& morph, Eigen::Index j)
{
    StoredVertices out;
    if (j == morph.deltas.cols()) return { morph.base.cast<double>(), morph.normals.base, false };
    out.positions = morph.deltas.col(j).cast<double>();
    if (morph.normals.base.size()) out.normals = morph.normals.deltas.col(j);
    return out;
}

StoredVertices stored_column(const GridMesh& mesh, Eigen::Index j)
{
    StoredVertices out;
    out.positions = mesh.positions.col(j).cast<double>();
    if (mesh.normals.size()) out.normals = mesh.normals.col(j).cast<double>();
    out.is_whole = true;
    return out;
}

// The box in steps of the grid, which hold it.
Eigen::VectorXd box_on(const Grid& grid, const Box& box)
{
    const Eigen::VectorXd corners = grid.steps_of(box.corners());
    return (Eigen::VectorXd(6) << corners.head(3).array().floor(), corners.tail(3).array().ceil()).finished();
}

template <class Mesh>
Json primitives_of(Glb& glb, const RenderScene& scene, const Mesh& mesh, const Eigen::VectorXd& box, Eigen::Index targets)
{
    Json primitives = add_primitives(glb, scene, stored_column(mesh, targets), box);
    for (Eigen::Index j = 0; j < targets; ++j) add_target(glb, scene, stored_column(mesh, j), primitives);
    return primitives;
}

// `frames`: weights of targets, d x frames.
void animate_weights(Glb& glb, const Eigen::MatrixXf& frames, double frames_per_second)
{
    const std::size_t input = add_times(glb, std::size_t(frames.cols()), frames_per_second);
    const std::size_t output
        = glb.add_floats(std::vector<float>(frames.data(), frames.data() + frames.size()), 1, Glb::Target::none);
    glb.json()["animations"]
        = { { { "name", "path" },
              { "samplers", { { { "input", input }, { "interpolation", "LINEAR" }, { "output", output } } } },
              { "channels", { { { "sampler", 0 }, { "target", { { "node", 0 }, { "path", "weights" } } } } } } } };
}

} // namespace

Json add_morph_mesh(Glb& glb, RuntimeBlender& blender, const DrawnSpace& space, const RenderScene& scene,
                    const ExportOptions& options, ExportReport& report, Grid& grid)
{
    const Eigen::MatrixXf path = path_coordinates(blender, options.path);
    const MorphMesh morph = make_morph_mesh(blender, space, path, options.with_normals);
    const PoseTable table = fit_pose_table(blender, morph);
    Json mesh;
    report.normal_error = morph.normal_error;
    if (options.quantisation_error > 0) {
        const GridMesh rounded = make_grid_mesh(morph, space, options.quantisation_error);
        grid = rounded.grid;
        report.position_error = rounded.error;
        report.normal_error = rounded.normal_error;
        mesh["primitives"] = primitives_of(glb, scene, rounded, box_on(grid, morph.reachable), morph.deltas.cols());
    } else {
        const Eigen::VectorXd box = morph.reachable.corners();
        mesh["primitives"] = primitives_of(glb, scene, morph, box, morph.deltas.cols());
    }
    if (!options.path.empty()) animate_weights(glb, morph.frames, options.frames_per_second);
    report.target_count = std::size_t(morph.deltas.cols());
    report.frame_count = options.path.size();
    report.diagonal = morph.reachable.diagonal();
    report.has_stored_ranges = morph.has_stored_ranges;
    report.table_mean = table.mean_error;
    report.table_largest = table.largest_error;
    report.centre_count = table.function.centres.size();
    mesh["weights"] = to_float_list(morph.poses.col(0));
    mesh["extras"] = extras_of_mesh(blender, morph, table, report);
    return mesh;
}

} // namespace pliant
