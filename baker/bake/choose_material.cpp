#include "bake/choose_material.h"

#include "base/common/diagnostics.h"
#include "base/common/parallel.h"
#include "base/mesh/decimate.h"
#include "base/mesh/surface.h"
#include "base/weights/sampling.h"
#include "elastic/average/family.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/average/shape_error.h"

#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

// Edges of a surface of unit area with so many vertices are ten times as long as the default shell is thick: folds of a
// shell are then no wider than a triangle, and what decides between them is the triangulation.
constexpr std::size_t few_vertices = 4000;

// Wrinkles that snap are there on a mesh of this size if they are there on the fine one, at a twentieth of its cost.
constexpr std::size_t coarse_vertex_count = 2000;

constexpr int probe_count = 12;
constexpr std::uint64_t probe_seed = 16;

// Averages from two sides differ by rounding of Newton's method, below 2e-4 relative L2, or by the width of a wrinkle.
constexpr double distinct = 2e-3;

bool is_default(const ShellOptions& shell)
{
    const ShellOptions standard;
    return shell.membrane == standard.membrane && shell.thickness == standard.thickness
        && shell.foldover_damping == standard.foldover_damping;
}

bool is_of_solids(Material material) { return material == Material::stvk || material == Material::mooney_rivlin; }

// How far apart the averages of a shell are that are found from the mean and from the linear blend.
struct Probe {
    Weights weights;
    double distance = 0;
    std::uint32_t vertex = 0;

    void compare(const NormalizedPoses& set, const Shape& a, const Shape& b)
    {
        const double apart = relative_distance(set, a, b);
        if (apart <= distance) return;
        distance = apart;
        vertex = std::uint32_t(farthest_vertex(set, a, b));
    }
};

Probe probe_at(const AverageFamily& family, const Weights& w, std::size_t worker, Progress* progress)
{
    const NormalizedPoses& set = family.pool().set();
    Probe probe { w };
    const Shape average = family.at(w, worker, progress).average.y;
    Shape blend = Shape::Zero(set.dof_count());
    for (std::size_t k = 0; k < set.pose_count(); ++k) blend += w[Eigen::Index(k)] * set.shapes[k];
    probe.compare(set, average, family.near(blend, w, worker, progress).y);
    return probe;
}

// The widest gap between averages of the shell; its vertex is one of the coarse mesh.
Probe probe_shell(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    const DiscreteShells shells(set, options.shell);
    SolverPool pool(shells, set, options.solver);
    NewtonOptions newton;
    newton.step_floor = 1e-4 * mass_norm(set.shapes[0], set.masses);
    AverageFamily family(pool, newton, progress);
    family.mean();
    Probe widest;
    for (const Branch& other : family.branches())
        if (other.distance > widest.distance) widest = { other.weights, other.distance, std::uint32_t(other.vertex) };
    if (widest.distance > distinct) return widest;
    const std::vector<Weights> weights = draw_weights(probe_seed, set.pose_count(), probe_count);
    std::vector<Probe> probes(weights.size());
    SharedProgress shared(progress);
    shared.describe("material", 0, "averages of a shell from two sides");
    for_each_task(weights.size(),
                  [&](std::size_t i, std::size_t worker) { probes[i] = probe_at(family, weights[i], worker, &shared); });
    for (const Probe& probe : probes)
        if (probe.distance > widest.distance) widest = probe;
    return widest;
}

MaterialChoice measure_surface(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    const CoarsePoses coarse = decimate(set, coarse_vertex_count);
    const Probe widest = probe_shell(coarse.set, options, progress);
    if (widest.distance <= distinct)
        return { Material::discrete_shells, "shells have the same averages from the mean and from the linear blend" };
    const std::uint32_t vertex = coarse.vertices[widest.vertex];
    return { Material::arap,
             fmt::format("a shell of these poses has several averages, {:.1f} % apart, most at vertex {}, weights {}",
                         100 * widest.distance, set.source_vertices.empty() ? vertex : set.source_vertices[vertex],
                         weights_text(widest.weights)) };
}

} // namespace

std::optional<Material> stated_material(const EnergyOptions& options, bool is_solid)
{
    std::optional<Material> material = options.material;
    if (!material && is_solid) material = Material::stvk;
    if (!material && (options.continuity == Continuity::off || !is_default(options.shell)))
        material = Material::discrete_shells;
    if (material && is_of_solids(*material) != is_solid)
        throw Failure(ExitCode::usage,
                      error_at(1206, "",
                               fmt::format("--material {} is for {}, the poses are {}", name_of(*material),
                                           is_solid ? "surfaces" : "solids", is_solid ? "solids" : "surfaces"),
                               is_solid ? "use stvk or mooney-rivlin" : "use discrete-shells or arap"));
    return material;
}

MaterialChoice choose_material(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress)
{
    if (const std::optional<Material> stated = stated_material(options, set.is_solid())) return { *stated, "" };
    const std::size_t vertex_count = std::size_t(set.dof_count() / 3);
    if (vertex_count <= few_vertices) return { Material::arap, fmt::format("a mesh of {} vertices", vertex_count) };
    const std::string defect = manifold_defect(set.triangles, vertex_count, set.source_vertices);
    if (!defect.empty())
        return { Material::discrete_shells, "not measured, since a coarse mesh needs a manifold: " + defect };
    return measure_surface(set, options, progress);
}

} // namespace pliant
