#include "bake/make_energy.h"

#include "base/common/diagnostics.h"
#include "elastic/energy/arap.h"
#include "elastic/energy/reinforced_shells.h"
#include "elastic/energy/solid.h"
#include "elastic/parts/calibrate_ties.h"
#include "elastic/parts/find_ties.h"

#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

// Each mesh has so many times the vertices of the next coarser one; below this number bodies lose fingers.
constexpr std::size_t coarsening = 4, least_vertex_count = 1000;

bool is_of_solids(Material material) { return material == Material::stvk || material == Material::mooney_rivlin; }

std::unique_ptr<Energy> make_surface_energy(const NormalizedPoses& set, Material material, const EnergyOptions& options)
{
    const Blend blend = options.blend.value_or(Blend::average);
    if (material == Material::arap) return std::make_unique<Arap>(set, blend);
    if (options.continuity == Continuity::off) return std::make_unique<DiscreteShells>(set, options.shell, blend);
    return std::make_unique<ReinforcedShells>(set, options.shell, blend);
}

// Which vertices have an ARAP cell.
std::vector<bool> centres_of_cells(const Energy& energy)
{
    const std::size_t count = std::size_t(energy.dof_count() / 3);
    if (const auto* shells = dynamic_cast<const ReinforcedShells*>(&energy)) return shells->is_rough();
    return std::vector<bool>(count, dynamic_cast<const Arap*>(&energy) != nullptr);
}

// The unit of a tie's stiffness is that with which triangles hold a vertex. In cells, each counts in those of its three
// corners.
TieSet ties_for(const NormalizedPoses& set, const std::vector<bool>& has_cell)
{
    constexpr double cells_per_triangle = 3;
    const auto stiffness_of = [&](const auto& v) {
        return std::any_of(v.begin(), v.end(), [&](auto i) { return has_cell[i]; }) ? cells_per_triangle : 1;
    };
    TieSet ties = find_ties(set);
    for (Tie& tie : ties.ties) tie.stiffness *= stiffness_of(tie.vertices);
    for (Joint& joint : ties.joints)
        for (PenaltyTerm& term : joint.terms) term.stiffness *= stiffness_of(term.vertices);
    return ties;
}

} // namespace

Material material_of(const EnergyOptions& options, bool is_solid)
{
    if (!options.material) return is_solid ? Material::stvk : Material::discrete_shells;
    if (is_of_solids(*options.material) == is_solid) return *options.material;
    throw Failure(ExitCode::usage,
                  error_at(1206, "",
                           fmt::format("--material {} is for {}, the poses are {}", name_of(*options.material),
                                       is_solid ? "surfaces" : "solids", is_solid ? "solids" : "surfaces"),
                           is_solid ? "use stvk or mooney-rivlin" : "use discrete-shells or arap"));
}

namespace {

std::unique_ptr<CoarseBody> make_coarse_body(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    const std::size_t count = std::size_t(set.dof_count() / 3) / coarsening;
    if (count < least_vertex_count || set.is_solid() || !set.is_free() || options.blend == Blend::layers) return nullptr;
    auto body = std::make_unique<CoarseBody>();
    body->poses = decimate(set, count);
    if (body->poses.failed_face || body->poses.vertices.size() > 2 * count) return nullptr;
    ElasticModel model = make_model(body->poses.set, options, progress);
    body->energy = std::move(model.energy);
    body->coarser = std::move(model.coarse);
    return body;
}

bool has_ties(const Energy& energy) { return ties_of(energy) != nullptr; }

std::unique_ptr<Energy> make_uncalibrated(const NormalizedPoses& set, const EnergyOptions& options)
{
    const Material material = material_of(options, set.is_solid());
    if (is_of_solids(material)) {
        const SolidLaw law = material == Material::stvk ? SolidLaw::stvk : SolidLaw::mooney_rivlin;
        return std::make_unique<Solid>(set, SolidOptions { law, options.poisson }, options.blend.value_or(Blend::average));
    }
    std::unique_ptr<Energy> surface = make_surface_energy(set, material, options);
    TieSet ties = ties_for(set, centres_of_cells(*surface));
    return tie_parts(std::move(surface), std::move(ties));
}

// With the coarse mesh that the ties were calibrated by, if there are ties.
ElasticModel make_calibrated(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    ElasticModel model { make_uncalibrated(set, options), nullptr };
    auto* tied = dynamic_cast<TiedEnergy*>(model.energy.get());
    if (!tied) return model;
    if (options.blend == Blend::layers) {
        tied->choose({}, std::vector<bool>(tied->ties().joints.size(), true));
        tied->drop_unused();
        return model;
    }
    model.coarse = make_coarse_body(set, options, progress);
    if (model.coarse && !has_ties(*model.coarse->energy)) model.coarse = nullptr;
    calibrate_ties(*tied, set, options.solver, model.coarse.get(), progress);
    return model;
}

} // namespace

std::unique_ptr<Energy> make_energy(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    return make_calibrated(set, options, progress).energy;
}

ElasticModel make_model(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    ElasticModel model = make_calibrated(set, options, progress);
    if (!has_ties(*model.energy)) model.coarse = make_coarse_body(set, options, progress);
    return model;
}

namespace {

// A surrogate energy that the material does not have is a wrong command line.
void check_surrogate(const BakeOptions& options, const PoseSet& poses)
{
    const Material material = *options.energy.material;
    if (options.surrogate == SurrogateKind::quartic && material != Material::stvk)
        throw Failure(ExitCode::usage,
                      error_at(1207, "", fmt::format("--energy quartic needs --material stvk, not {}", name_of(material)),
                               "leave it out, or use --energy cubature"));
    if (options.surrogate == SurrogateKind::ghost && poses.is_solid())
        throw Failure(ExitCode::usage,
                      error_at(1208, "", "--energy ghost is for surfaces, the poses are solids",
                               "leave it out, or use --energy cubature"));
    if (options.surrogate == SurrogateKind::ghost) // before the minutes that come before the ghost
        require_manifold(poses.triangles, poses.vertex_count(), poses.source_vertices, "--energy ghost",
                         "repair it the same way in all poses, or use --energy cubature, which does not need one");
}

} // namespace

namespace {

// What of a bake layers do not have.
const char* missing_of_layers(const BakeOptions& options, const PoseSet& poses)
{
    if (poses.is_solid()) return "solids";
    if (options.energy.shell.membrane != Membrane::neo_hookean) return "--membrane stvk and edge";
    if (options.subspace != SubspaceKind::adaptive) return "--subspace krylov and barbic";
    return options.surrogate == SurrogateKind::ghost ? "--energy ghost" : nullptr;
}

void check_blend(const BakeOptions& options, const PoseSet& poses)
{
    const auto refuse = [](const char* what, const std::string& with, const char* hint) {
        throw Failure(ExitCode::usage, error_at(1234, "", fmt::format("{} cannot be baked with {}", what, with), hint));
    };
    if (options.energy.blend == Blend::layers) {
        if (const char* what = missing_of_layers(options, poses))
            refuse(what, "--blend layers",
                   "leave it out, or bake the poses with --blend average; `pliant average` has both");
    } else if (options.energy.keep_placement && poses.fixed_vertices.empty() && options.subspace != SubspaceKind::adaptive) {
        refuse("--subspace krylov and barbic", "poses that stay where they are (--no-align, or all of one glTF file)",
               "leave it out: these subspaces know no way from place to place");
    } else if (poses.pose_count() > few_poses && options.subspace != SubspaceKind::adaptive) {
        refuse("--subspace krylov and barbic", fmt::format("more than {} poses", few_poses),
               "leave it out, or choose the poses that differ most");
    }
}

} // namespace

BakeOptions resolve_options(const BakeOptions& given, const PoseSet& poses)
{
    BakeOptions options = given;
    options.energy.blend = given.energy.blend.value_or(poses.blend);
    options.energy.material = material_of(given.energy, poses.is_solid());
    options.energy.keep_placement = given.energy.keep_placement || poses.share_frame;
    check_surrogate(options, poses);
    check_blend(options, poses);
    return options;
}

} // namespace pliant
