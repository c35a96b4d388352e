#include "bake/certificate.h"

#include "base/common/diagnostics.h"
#include "base/common/foreign_json.h"
#include "base/common/version.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace pliant {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Weights& w) { return std::vector<double>(w.data(), w.data() + w.size()); }

Json json_of(const ShapeError& error)
{
    Json json = { { "relative_l2", error.relative_l2 }, { "largest_distance", error.largest_distance } };
    if (!std::isnan(error.energy_excess)) json["energy_excess"] = error.energy_excess;
    return json;
}

template <class Enum> Enum parse_name(const std::string& name, std::initializer_list<Enum> values)
{
    for (Enum value : values)
        if (name == name_of(value)) return value;
    throw std::invalid_argument(name);
}

} // namespace

namespace {

Json subspace_of(const BakeReport& report, const BakeOptions& options)
{
    Json subspace = { { "kind", name_of(options.subspace) }, { "dimension", report.fit.dimension } };
    if (options.subspace == SubspaceKind::krylov) subspace["ritz"] = options.ritz_count;
    if (options.subspace == SubspaceKind::adaptive) {
        subspace["snapshots"] = report.snapshot_count;
        subspace["interpolated_averages"] = report.interpolated_count;
        subspace["unconverged_averages"] = report.unconverged_snapshot_count;
    }
    subspace["mean_error"] = report.fit.subspace_error.mean;
    subspace["largest_error"] = report.fit.subspace_error.largest;
    return subspace;
}

Json basis_of(const BakeReport& report, const BakeOptions& options)
{
    return { { "compact", report.check.basis.is_compact },
             { "position_error", options.basis_error() },
             { "largest_difference", report.check.basis.largest_difference },
             { "bytes_per_number", report.check.basis.bytes_per_number } };
}

Json surrogate_of(const BakeReport& report, const BakeOptions& options)
{
    const SurrogateReport& r = report.fit.surrogate;
    Json surrogate = { { "kind", name_of(report.fit.kind) },
                       { "elements", report.fit.element_count },
                       { "training_weights", report.fit.training_count },
                       { "unconverged_training_weights", report.fit.unconverged_training_count },
                       { "lowest_curvature", r.curvature.lowest },
                       { "highest_curvature", r.curvature.highest },
                       { "dead_load", r.has_load },
                       { "mean_error_without_load", r.plain.mean },
                       { "largest_error_without_load", r.plain.largest } };
    if (report.fit.kind == SurrogateKind::cubature)
        surrogate["cubature"] = options.cubature_solver == CubatureSolver::nn_htp ? "nn-htp" : "nnls";
    if (!report.fit.reason.empty()) surrogate["reason"] = report.fit.reason;
    if (r.loaded.mean > 0) {
        surrogate["mean_error_with_load"] = r.loaded.mean;
        surrogate["largest_error_with_load"] = r.loaded.largest;
    }
    return surrogate;
}

Json findings_of(const BakeReport& report, const std::vector<std::string>& pose_names)
{
    constexpr const char* kinds[] = { "other mean", "jump", "other path", "turn" }; // in the order of Branch::Kind
    Json branches = Json::array();
    for (const Branch& branch : report.branches)
        branches.push_back({ { "kind", kinds[std::size_t(branch.kind)] },
                             { "weights", json_of(branch.weights) },
                             { "pose", pose_names[branch.pose] },
                             { "distance", branch.distance },
                             { "vertex", branch.vertex } });
    return branches;
}

Json measured_of(const BakeReport& report)
{
    const char* const cell = report.input.tet_count ? "smallest_j" : "smallest_triangle_ratio";
    Json checks = Json::array();
    int unconverged = 0;
    for (const BlendCheck& check : report.check.blends) {
        Json json = json_of(check.error);
        json[cell] = check.cell_ratio;
        json["fresh"] = check.is_fresh;
        json["converged"] = check.has_converged;
        json["near_jump"] = check.is_near_jump;
        json["weights"] = json_of(check.weights);
        if (*check.kind) {
            json["kind"] = check.kind;
            json["linear_error"] = check.linear_error;
        }
        unconverged += !check.has_converged;
        checks.push_back(json);
    }
    Json measured = { { "mean_error", report.check.mean_error },
                      { "largest_error", report.check.largest_error },
                      { "largest_distance", report.check.largest_distance },
                      { cell, report.check.cell_ratio },
                      { "worst_weights", json_of(report.check.worst_weights) },
                      { "runtime_against_double", report.check.runtime_error },
                      { "unconverged_checks", unconverged },
                      { "checks", checks } };
    return measured;
}

// Of layers: the ranges of their weights, and the errors of each kind of mixture beside those of linear sums.
Json layers_of(const BakeReport& report, const std::vector<std::string>& pose_names)
{
    Json ranges = Json::array(), errors = Json::array();
    for (std::size_t k = 0; k < report.input.ranges.size(); ++k) {
        const WeightRange& range = report.input.ranges[k];
        ranges.push_back({ { "layer", pose_names[k + 1] }, { "low", range.low }, { "high", range.high } });
    }
    for (const KindErrors& kind : report.check.kinds)
        errors.push_back({ { "kind", kind.kind },
                           { "count", kind.count },
                           { "without_shape", kind.lost_count },
                           { "mean_error", kind.mean },
                           { "largest_error", kind.largest },
                           { "linear_mean_error", kind.linear_mean },
                           { "linear_largest_error", kind.linear_largest } });
    return { { "ranges", ranges }, { "errors", errors } };
}

Json drift_of(const WorstDrift& worst)
{
    Json drift = { { "largest", worst.drift.largest }, { "part", worst.drift.part }, { "vertex", worst.drift.vertex } };
    drift["weights"] = json_of(worst.weights);
    return drift;
}

Json ties_of(const TieReport& report)
{
    Json ties = { { "parts", report.part_count },
                  { "ties", report.tie_count },
                  { "seam_ties", report.seam_count },
                  { "joints", report.joint_count } };
    if (report.blends.weights.size() > 0) {
        ties["drift_of_averages"] = drift_of(report.reference);
        ties["drift_of_blends"] = drift_of(report.blends);
    }
    return ties;
}

// How the mesh of the energy differs from the one of the files, which is drawn.
Json elastic_of(const BakeReport& report)
{
    const SurfaceRepairs& r = report.input.repairs;
    return { { "drawn_vertices", report.input.drawn_vertex_count },
             { "drawn_triangles", report.input.drawn_triangle_count },
             { "welded_vertices", r.welded_count },
             { "repeated_vertex_triangles", r.repeated_count },
             { "flat_triangles", r.flat_count },
             { "duplicate_triangles", r.duplicate_count } };
}

// What its triangles have that a manifold has not.
Json irregular_of(const SurfaceRepairs& r)
{
    return { { "lone_vertices", r.lone_vertex_count },
             { "components", r.component_count },
             { "edges_of_many_faces", r.crowded_edge_count },
             { "edges_of_turned_faces", r.turned_edge_count } };
}

Json drawn_of(const BakeReport& report, const RenderMesh& surface)
{
    Json drawn = { { "vertices", surface.embedding.count() },
                   { "triangles", surface.triangles.size() },
                   { "outside", surface.outside_count },
                   { "farthest_outside", surface.farthest_outside },
                   { "largest_weight", surface.largest_weight } };
    if (report.check.render_mesh && !report.check.blends.empty()) {
        drawn["mean_error"] = report.check.render_mesh->mean;
        drawn["largest_error"] = report.check.render_mesh->largest;
        drawn["largest_distance"] = report.check.render_mesh->largest_distance;
    }
    return drawn;
}

} // namespace

std::string write_certificate(const BakeReport& report, const BakeOptions& options,
                              const std::vector<std::string>& pose_names)
{
    const ShellOptions& shell = options.energy.shell;
    const Material material = report.input.material;
    Json energy = { { "material", name_of(material) } };
    if (options.energy.blend == Blend::layers) energy["blend"] = name_of(Blend::layers);
    if (report.input.tet_count && options.energy.poisson >= 0) energy["poisson"] = options.energy.poisson;
    if (material == Material::discrete_shells) {
        energy["membrane"] = name_of(shell.membrane);
        energy["thickness"] = shell.thickness;
        energy["continuity"] = name_of(options.energy.continuity);
        if (options.energy.continuity == Continuity::off)
            energy["foldover_damping"] = shell.foldover_damping;
        else
            energy["rough_vertices"] = report.input.rough_count;
        if (report.input.rough_count > 0) energy["roughest_vertex"] = report.input.roughest_vertex;
    }
    energy["aligned"] = report.input.is_aligned;
    energy["solver"] = name_of(options.energy.solver);
    if (report.input.repairs.welded_count > 0) energy["weld"] = options.energy.weld_tolerance;
    if (!report.input.fixed_vertices.empty()) energy["fixed_vertices"] = report.input.fixed_vertices;

    Json certificate = {
        { "certificate", 1 }, { "baker", baker_version }, { "poses", pose_names }, { "vertices", report.input.vertex_count }
    };
    if (report.input.tet_count) certificate["tetrahedra"] = report.input.tet_count;
    if (report.input.drawn_vertex_count > 0) certificate["elastic"] = elastic_of(report);
    if (report.input.repairs.is_irregular()) certificate["irregular"] = irregular_of(report.input.repairs);
    if (options.render_mesh) certificate["surface"] = drawn_of(report, *options.render_mesh);
    certificate["energy"] = energy;
    if (report.check.ties) certificate["ties"] = ties_of(*report.check.ties);
    if (!report.input.ranges.empty()) certificate["layers"] = layers_of(report, pose_names);
    certificate["tolerance"] = options.tolerance;
    if (options.tolerance_max > 0) certificate["tolerance_max"] = options.tolerance_max;
    if (options.time_limit) certificate["time_limit"] = *options.time_limit;
    certificate["meets_tolerance"] = report.check.meets_tolerance;
    certificate["subspace"] = subspace_of(report, options);
    certificate["basis"] = basis_of(report, options);
    certificate["stand_in"] = surrogate_of(report, options);
    certificate["measured"] = measured_of(report);
    certificate["mean_from_pose"] = report.start_pose;
    certificate["branches"] = findings_of(report, pose_names);
    certificate["foldover_hinges"] = report.input.foldover_count;
    certificate["factorizations"] = report.factorization_count;
    certificate["seed"] = options.seed;
    // Names of poses are those of files, whose bytes need not be UTF-8.
    return certificate.dump(1, ' ', false, Json::error_handler_t::replace);
}

namespace {

// Throws what the reader of the certificate catches.
double within(const NumberRange& range, double number)
{
    if (!(number >= range.least && number <= range.most)) throw std::out_of_range("certificate");
    return number;
}

std::vector<std::uint32_t> ascending_numbers(const Json& list)
{
    std::vector<std::uint32_t> numbers;
    for (const Json& item : list) {
        const bool is_whole = item.is_number_unsigned() && item.get<std::uint64_t>() <= UINT32_MAX;
        if (!is_whole || (!numbers.empty() && item.get<std::uint64_t>() <= numbers.back()))
            throw std::invalid_argument("fixed_vertices");
        numbers.push_back(item.get<std::uint32_t>());
    }
    return numbers;
}

} // namespace

EnergyOptions read_energy_options(const std::string& certificate, bool has_layers, const std::string& path)
{
    EnergyOptions options;
    try {
        const Json json = parse_foreign_json(certificate);
        const Json& energy = json.at("energy");
        options.material
            = parse_name(energy.at("material").get<std::string>(),
                         { Material::discrete_shells, Material::arap, Material::stvk, Material::mooney_rivlin });
        options.blend = parse_name(energy.value("blend", "average"), { Blend::average, Blend::layers });
        if ((options.blend == Blend::layers) != has_layers) throw std::invalid_argument("blend");
        if (energy.contains("poisson")) options.poisson = within(poisson_range, energy["poisson"].get<double>());
        options.weld_tolerance = within(weld_range, energy.value("weld", 0.0)); // none: nothing was welded
        if (energy.contains("fixed_vertices")) options.fixed_vertices = ascending_numbers(energy["fixed_vertices"]);
        options.keep_placement = !energy.at("aligned").get<bool>();
        if (options.material == Material::discrete_shells) {
            ShellOptions& shell = options.shell;
            shell.membrane = parse_name(energy.at("membrane").get<std::string>(),
                                        { Membrane::neo_hookean, Membrane::stvk, Membrane::edge });
            shell.thickness = within(thickness_range, energy.at("thickness").get<double>());
            shell.foldover_damping
                = within(foldover_damping_range, energy.value("foldover_damping", shell.foldover_damping));
            options.continuity = parse_name(energy.value("continuity", "off"),
                                            { Continuity::automatic, Continuity::off }); // older certificates do not say
        }
    } catch (const std::exception&) {
        throw Failure(
            ExitCode::bad_input,
            error_at(5103, path, "its certificate does not say how it was baked", "bake it again with this version"));
    }
    return options;
}

std::optional<std::size_t> read_start_pose(const std::string& certificate, std::size_t pose_count, const std::string& path)
{
    const Json json = parse_foreign_json(certificate);
    if (!json.is_object() || !json.contains("mean_from_pose") || !json["mean_from_pose"].is_number_unsigned()) return {};
    const auto pose = json["mean_from_pose"].get<std::uint64_t>();
    if (pose < pose_count) return std::size_t(pose);
    throw Failure(ExitCode::bad_input,
                  error_at(5103, path, fmt::format("its certificate starts from pose {} of {}", pose, pose_count),
                           "bake it again with this version"));
}

namespace {

// More of them nobody reads; each names at most Diagnostic::element_limit vertices and faces.
constexpr std::size_t warning_limit = 100;

Json warnings_of(const std::vector<Diagnostic>& warnings)
{
    Json json = Json::array();
    for (const Diagnostic& warning : warnings) {
        if (json.size() == warning_limit) break;
        json.push_back({ { "number", warning.number },
                         { "where", warning.where },
                         { "what", warning.what },
                         { "hint", warning.hint },
                         { "vertices", warning.vertices },
                         { "faces", warning.faces } });
    }
    return json;
}

} // namespace

double read_position_error(const std::string& certificate)
{
    const Json json = parse_foreign_json(certificate);
    const Json::json_pointer place("/basis/position_error");
    const bool is_there = json.is_object() && json.contains(place) && json.at(place).is_number();
    return is_there ? std::clamp(json.at(place).get<double>(), 0.0, 1e-2) : 0.0; // what --position-error takes
}

std::string write_report(const BakeReport& report, const std::string& asset, const std::vector<Diagnostic>& warnings)
{
    Json json = Json::parse(report.certificate);
    Json stages = Json::object();
    for (const StageTime& stage : report.stages) stages[stage.stage] = stage.seconds;
    json["seconds"] = stages;
    json["cubature_residual"] = report.fit.surrogate.residual;
    if (!asset.empty()) json["asset"] = asset;
    json["warnings"] = warnings_of(warnings);
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; // file names may be anything
}

} // namespace pliant
