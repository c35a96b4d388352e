#include "cli/idle_options.h"

#include "bake/make_energy.h"
#include "cli/console.h"

#include <fmt/format.h>

namespace pliant {
namespace {

struct Field {
    const char* option;
    const char* field; // what the option is for
    bool is_there;
};

// The value of an option that takes a name; empty where the verb has no such option.
std::string value_of(const CLI::App& verb, const char* name)
{
    const CLI::Option* const option = verb.get_option_no_throw(name);
    if (!option) return {};
    return option->count() > 0 ? option->results().back() : option->get_default_str();
}

std::vector<Field> fields(const CLI::App& verb, const EnergyOptions& energy, bool is_solid)
{
    const bool is_shell = material_of(energy, is_solid) == Material::discrete_shells;
    const bool has_hinges = is_shell && energy.continuity == Continuity::off;
    const std::string subspace = value_of(verb, "--subspace"), surrogate = value_of(verb, "--energy");
    const bool has_cubature = surrogate != "ghost" && surrogate != "quartic";
    return {
        { "--poisson", "solids", is_solid },
        { "--weld", "surfaces", !is_solid },
        { "--continuity", "thin shells (--material discrete-shells)", is_shell },
        { "--membrane", "thin shells (--material discrete-shells)", is_shell },
        { "--thickness", "thin shells (--material discrete-shells)", is_shell },
        { "--foldover-damping", "thin shells with --continuity off", has_hinges },
        { "--ritz", "--subspace krylov", subspace == "krylov" },
        { "--ghost-vertices", "--energy ghost", surrogate == "ghost" },
        { "--elements", "--energy cubature", has_cubature },
        { "--cubature", "--energy cubature", has_cubature },
    };
}

} // namespace

void warn_of_idle_options(const CLI::App& verb, const EnergyOptions& energy, bool is_solid, std::vector<Diagnostic>& kept)
{
    for (const Field& field : fields(verb, energy, is_solid)) {
        const CLI::Option* const option = verb.get_option_no_throw(field.option);
        if (field.is_there || !option || option->count() == 0) continue;
        kept.push_back(warning_at(1238, "", fmt::format("{} changes nothing here: it is for {}", field.option, field.field),
                                  "leave it out"));
        print_finding(verb.get_name(), kept.back());
    }
}

} // namespace pliant
