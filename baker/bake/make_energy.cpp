#include "bake/make_energy.h"

#include "base/common/diagnostics.h"
#include "elastic/energy/arap.h"
#include "elastic/energy/solid.h"
#include "elastic/parts/calibrate_ties.h"
#include "elastic/parts/find_ties.h"

#include <fmt/core.h>

namespace pliant {

Material material_for(const EnergyOptions& options, bool is_solid)
{
    const Material material = options.material.value_or(is_solid ? Material::stvk : Material::discrete_shells);
    const bool is_of_solids = material == Material::stvk || material == Material::mooney_rivlin;
    if (is_of_solids != is_solid)
        throw Failure(ExitCode::usage,
                      error_at(1206, "",
                               fmt::format("--material {} is for {}, the poses are {}", name_of(material),
                                           is_of_solids ? "solids" : "surfaces", is_solid ? "solids" : "surfaces"),
                               is_solid ? "use stvk or mooney-rivlin" : "use discrete-shells or arap"));
    return material;
}

std::unique_ptr<Energy> make_energy(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    switch (material_for(options, set.is_solid())) {
    case Material::arap: return std::make_unique<Arap>(set);
    case Material::stvk: return std::make_unique<Solid>(set, SolidOptions { SolidLaw::stvk, options.poisson });
    case Material::mooney_rivlin:
        return std::make_unique<Solid>(set, SolidOptions { SolidLaw::mooney_rivlin, options.poisson });
    default: break;
    }
    std::unique_ptr<Energy> energy = tie_parts(std::make_unique<DiscreteShells>(set, options.shell), find_ties(set));
    if (auto* tied = dynamic_cast<TiedEnergy*>(energy.get())) calibrate_ties(*tied, set, options.solver, progress);
    return energy;
}

namespace {

// A surrogate energy that the material does not have is a wrong command line.
void check_surrogate(const BakeOptions& options, const PoseSet& poses)
{
    const Material material = *options.energy.material;
    const bool is_solid = material == Material::stvk || material == Material::mooney_rivlin;
    if (options.surrogate == SurrogateKind::quartic && material != Material::stvk)
        throw Failure(ExitCode::usage,
                      error_at(1207, "", fmt::format("--energy quartic needs --material stvk, not {}", name_of(material)),
                               "leave it out, or use --energy cubature"));
    if (options.surrogate == SurrogateKind::ghost && is_solid)
        throw Failure(ExitCode::usage,
                      error_at(1208, "", "--energy ghost is for surfaces, the poses are solids",
                               "leave it out, or use --energy cubature"));
    if (options.surrogate == SurrogateKind::ghost) // before the minutes that come before the ghost
        require_manifold(poses.triangles, poses.vertex_count(), poses.source_vertices, "--energy ghost",
                         "repair it the same way in all poses, or use --energy cubature, which does not need one");
}

} // namespace

BakeOptions resolve_options(const BakeOptions& given, const PoseSet& poses)
{
    BakeOptions options = given;
    options.energy.material = material_for(given.energy, poses.is_solid());
    check_surrogate(options, poses);
    return options;
}

} // namespace pliant
