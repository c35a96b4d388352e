#include "options.h"

#include "bake/certificate.h"

#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace pliant {
namespace {

// Leaves `value` as it is where nothing was given.
template <class T> void take(const nb::dict& given, const char* name, T& value)
{
    if (given.contains(name) && !given[name].is_none()) value = nb::cast<T>(given[name]);
}

// Names of the command line that no certificate has.
std::string spelled(CubatureSolver solver) { return solver == CubatureSolver::nn_htp ? "nn-htp" : "nnls"; }

std::string spelled(SurrogateKind kind) { return kind == SurrogateKind::automatic ? "auto" : name_of(kind); }

template <class Enum> std::string spelled(Enum value) { return name_of(value); }

template <class Enum, class Target>
void take_choice(const nb::dict& given, const char* option, Target& value, std::initializer_list<Enum> values)
{
    std::string wanted, known;
    take(given, option, wanted);
    if (wanted.empty() && (!given.contains(option) || given[option].is_none())) return;
    for (const Enum one : values) {
        if (spelled(one) == wanted) {
            value = one;
            return;
        }
        known += (known.empty() ? "'" : ", '") + spelled(one) + "'";
    }
    throw nb::value_error(fmt::format("{}: expected one of {}, got '{}'", option, known, wanted).c_str());
}

} // namespace

EnergyOptions energy_options(const nb::dict& given)
{
    EnergyOptions options;
    take_choice(given, "blend", options.blend, { Blend::average, Blend::layers });
    take_choice(given, "material", options.material,
                { Material::discrete_shells, Material::arap, Material::stvk, Material::mooney_rivlin });
    take_choice(given, "continuity", options.continuity, { Continuity::automatic, Continuity::off });
    take_choice(given, "membrane", options.shell.membrane, { Membrane::neo_hookean, Membrane::stvk, Membrane::edge });
    if (has_cholmod())
        take_choice(given, "solver", options.solver, { SolverKind::cholmod, SolverKind::eigen });
    else
        take_choice(given, "solver", options.solver, { SolverKind::eigen });
    take(given, "poisson", options.poisson);
    take(given, "thickness", options.shell.thickness);
    take(given, "foldover_damping", options.shell.foldover_damping);
    take(given, "weld", options.weld_tolerance);
    take(given, "no_align", options.keep_placement);
    take(given, "fix", options.fixed_vertices);
    if (!options.fixed_vertices.empty()) options.keep_placement = true;
    return options;
}

BakeOptions bake_options(const nb::dict& given)
{
    BakeOptions options;
    options.energy = energy_options(given);
    std::vector<std::tuple<std::string, double, double>> ranges;
    take(given, "range", ranges);
    for (const auto& [layer, low, high] : ranges) options.ranges.push_back({ layer, { low, high } });
    take_choice(given, "subspace", options.subspace, { SubspaceKind::adaptive, SubspaceKind::krylov, SubspaceKind::barbic });
    take_choice(given, "energy", options.surrogate,
                { SurrogateKind::automatic, SurrogateKind::quartic, SurrogateKind::cubature, SurrogateKind::ghost });
    take_choice(given, "cubature", options.cubature_solver, { CubatureSolver::nnls, CubatureSolver::nn_htp });
    take(given, "tolerance", options.tolerance);
    take(given, "tolerance_max", options.tolerance_max);
    take(given, "ritz", options.ritz_count);
    take(given, "dim", options.dimension);
    take(given, "elements", options.element_count);
    take(given, "ghost_vertices", options.ghost_vertex_count);
    take(given, "check_samples", options.check_count);
    take(given, "fresh_samples", options.fresh_count);
    require_comparisons(options, given.contains("tolerance"));
    if (given.contains("position_error")) options.position_error = nb::cast<double>(given["position_error"]);
    take(given, "seed", options.seed);
    if (given.contains("time_limit")) options.time_limit = nb::cast<double>(given["time_limit"]);
    if (given.contains("preview")) make_preview(options, given.contains("tolerance"));
    bool has_no_scene = false;
    take(given, "no_scene", has_no_scene);
    options.keep_scene = !has_no_scene;
    return options;
}

LoadOptions load_options(const EnergyOptions& options)
{
    LoadOptions load;
    load.blend = options.blend;
    load.align = !options.keep_placement;
    load.fixed_vertices = options.fixed_vertices;
    if (!options.fixed_vertices.empty()) load.fixed_name = "fix";
    load.weld_tolerance = options.weld_tolerance;
    return load;
}

} // namespace pliant
