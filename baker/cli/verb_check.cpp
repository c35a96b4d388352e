#include "cli/verbs.h"

#include "energy/discrete_shells.h"

#include <fmt/core.h>
#include <memory>

namespace pliant {

namespace {

struct Arguments {
    std::vector<std::string> poses;
    BakeOptions bake;
};

void print_surface(const PoseSet& poses)
{
    const DrawnSurface* const drawn = poses.drawn.get();
    fmt::print("{} poses of {} vertices, {} faces, {} triangles: fit to bake\n", poses.pose_count(),
               drawn ? drawn->embedding.count() : poses.vertex_count(), poses.polygons.count(),
               drawn ? drawn->triangles.size() : poses.triangles.size());
    if (drawn)
        fmt::print("  the elastic mesh has {} vertices, {} triangles in {} components\n", poses.vertex_count(),
                   poses.triangles.size(), poses.repairs.component_count);
}

ExitCode run(const Arguments& a)
{
    const PoseSet poses = load_with_warnings("check", a.poses, a.bake.energy);
    const ShapeSet set = normalise(poses, a.bake.energy.keep_placement);
    const Material material = material_for(a.bake.energy, poses.is_solid());
    if (poses.is_solid())
        fmt::print("{} poses of {} vertices, {} tetrahedra, {} of the vertices on the boundary: fit to bake\n",
                   poses.pose_count(), poses.vertex_count(), poses.tets.size(), poses.boundary_vertex_count);
    else
        print_surface(poses);
    for (std::size_t k = 1; k < poses.pose_count(); ++k)
        fmt::print("  {}: turned by {:.1f} degrees to meet {}\n", poses.names[k],
                   Eigen::AngleAxisd(set.motions[k].rotation).angle() * 57.29577951308232, poses.names[0]);
    if (material == Material::discrete_shells) {
        const DiscreteShells shells(set, a.bake.energy.shell);
        if (!shells.foldover_hinges().empty())
            fmt::print("  {} of {} hinges are folded over or fold strongly between poses: their bending will be damped\n",
                       shells.foldover_hinges().size(), shells.hinge_count());
    }
    const BakeEstimate e = estimate_bake(poses.vertex_count(), poses.pose_count(), a.bake);
    fmt::print("a bake would have d = {}, take roughly {:.0f} s and {:.1f} GiB, and write {:.1f} MiB\n", e.dimension,
               e.seconds, e.memory / 1073741824.0, e.asset_size / 1048576.0);
    return ExitCode::done;
}

} // namespace

Verb add_check(CLI::App& app)
{
    auto a = std::make_shared<Arguments>();
    CLI::App* verb = app.add_subcommand("check", "Check poses and say what a bake would cost; writes nothing");
    verb->footer(
        "Example:\n  pliant check rest.ply run.ply jump.ply\nReports everything that is wrong with all files in one run.");
    add_pose_arguments(*verb, a->poses);
    add_energy_options(*verb, a->bake.energy);
    verb->add_option("--dim", a->bake.dimension, "As for bake")->check(CLI::Range(1, 256));
    return [a] { return run(*a); };
}

} // namespace pliant
