#include "report/certificate.h"

#include "report/diagnostics.h"

#include <nlohmann/json.hpp>

namespace pliant {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Weights& w) { return std::vector<double>(w.data(), w.data() + w.size()); }

Json json_of(const ShapeError& error)
{
    return { { "relative_l2", error.relative_l2 },
             { "largest_distance", error.largest_distance },
             { "energy_excess", error.energy_excess } };
}

template <class Enum> Enum parse_name(const std::string& name, std::initializer_list<Enum> values)
{
    for (Enum value : values)
        if (name == name_of(value)) return value;
    throw std::invalid_argument(name);
}

} // namespace

const char* name_of(Material material) { return material == Material::arap ? "arap" : "discrete-shells"; }

const char* name_of(Membrane membrane)
{
    switch (membrane) {
    case Membrane::stvk: return "stvk";
    case Membrane::edge: return "edge";
    default: return "neo-hookean";
    }
}

const char* name_of(SubspaceKind kind)
{
    return kind == SubspaceKind::krylov ? "krylov" : kind == SubspaceKind::barbic ? "barbic" : "adaptive";
}
const char* name_of(StandInKind kind) { return kind == StandInKind::ghost ? "ghost" : "cubature"; }
const char* name_of(SolverKind kind) { return kind == SolverKind::eigen ? "eigen" : "cholmod"; }

namespace {

Json subspace_of(const BakeReport& report, const BakeOptions& options)
{
    Json subspace = { { "kind", name_of(options.subspace) }, { "dimension", report.dimension } };
    if (options.subspace == SubspaceKind::krylov) {
        subspace["ritz"] = options.ritz_count;
        return subspace;
    }
    if (options.subspace != SubspaceKind::adaptive) return subspace;
    const AdaptiveReport& adaptive = report.adaptive;
    subspace["tolerance"] = options.tolerance;
    subspace["meets_tolerance"] = adaptive.meets_tolerance;
    subspace["snapshots"] = adaptive.snapshot_count;
    subspace["checks"] = adaptive.check_count;
    subspace["unconverged_averages"] = adaptive.unconverged_count;
    subspace["mean_error"] = adaptive.mean_error;
    subspace["largest_error"] = adaptive.largest_error;
    subspace["worst_weights"] = json_of(adaptive.worst_weights);
    return subspace;
}

} // namespace

std::string write_certificate(const BakeReport& report, const BakeOptions& options,
                              const std::vector<std::string>& pose_names)
{
    const ShellOptions& shell = options.energy.shell;
    Json energy = { { "material", name_of(options.energy.material) } };
    if (options.energy.material == Material::discrete_shells) {
        energy["membrane"] = name_of(shell.membrane);
        energy["thickness"] = shell.thickness;
        energy["foldover_damping"] = shell.foldover_damping;
    }
    energy["aligned"] = !options.energy.keep_placement;
    energy["solver"] = name_of(options.energy.solver);

    Json checks = Json::array();
    for (const auto& [weights, error] : report.checks) {
        Json check = json_of(error);
        check["weights"] = json_of(weights);
        checks.push_back(check);
    }
    const Json certificate = {
        { "certificate", 1 },
        { "baker", "pliant 0.1.0" },
        { "poses", pose_names },
        { "vertices", report.vertex_count },
        { "energy", energy },
        { "subspace", subspace_of(report, options) },
        { "stand_in",
          { { "kind", name_of(options.stand_in) },
            { "elements", report.element_count },
            { "lowest_curvature", report.cubature.lowest_curvature },
            { "highest_curvature", report.cubature.highest_curvature } } },
        { "seed", options.seed },
        { "foldover_hinges", report.foldover_count },
        { "measured",
          { { "runtime_against_double", report.stand_in_error },
            { "unconverged_training_weights", report.unconverged_training_count },
            { "unconverged_checks", report.unconverged_check_count },
            { "against_unreduced", checks } } },
    };
    return certificate.dump(1);
}

EnergyOptions read_energy_options(const std::string& certificate, const std::string& path)
{
    EnergyOptions options;
    try {
        const Json json = Json::parse(certificate);
        const Json& energy = json.at("energy");
        options.material
            = parse_name(energy.at("material").get<std::string>(), { Material::discrete_shells, Material::arap });
        options.keep_placement = !energy.at("aligned").get<bool>();
        if (options.material == Material::discrete_shells) {
            options.shell.membrane = parse_name(energy.at("membrane").get<std::string>(),
                                                { Membrane::neo_hookean, Membrane::stvk, Membrane::edge });
            options.shell.thickness = energy.at("thickness").get<double>();
            options.shell.foldover_damping = energy.at("foldover_damping").get<double>();
        }
    } catch (const std::exception&) {
        throw Failure(
            ExitCode::bad_input,
            error_at(5103, path, "its certificate does not say how it was baked", "bake it again with this version"));
    }
    return options;
}

std::string write_report(const BakeReport& report)
{
    Json json = Json::parse(report.certificate);
    Json stages = Json::object();
    for (const StageTime& stage : report.stages) stages[stage.stage] = stage.seconds;
    json["seconds"] = stages;
    json["factorizations"] = report.factorization_count;
    json["cubature_residual"] = report.cubature.residual;
    return json.dump(1) + "\n";
}

} // namespace pliant
