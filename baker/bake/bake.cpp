#include "bake/bake.h"

#include "bake/certificate.h"
#include "bake/estimate.h"
#include "bake/find_subspace.h"
#include "bake/fit.h"
#include "bake/make_energy.h"
#include "bake/self_check.h"
#include "bake/stopwatch.h"
#include "bake/warnings.h"
#include "base/common/memory.h"
#include "base/mesh/align.h"
#include "elastic/energy/reinforced_shells.h"
#include "elastic/parts/tied_energy.h"
#include "output/asset/runtime_blender.h"

#include <algorithm>

namespace pliant {

namespace {

// Where the bar stands at the end of each stage: shares of the time that bakes with the default options take, means of two
// bodies, the creature and a robot in parts. Three stages stand for each other.
std::vector<PlannedStage> plan_stages()
{
    return { { "poses", 0.01 },
             { "ties", 0.02 },
             { "mean", 0.20 },
             { "averages", 0.49 },
             { "averages to check", 0.60 },
             { "subspace", 0.61 },
             { "reduced averages", 0.62 },
             { "training", 0.68 },
             { "quartic", 0.93 },
             { "ghost", 0.93 },
             { "cubature", 0.93, true },
             { "fresh averages", 0.97 },
             { "check", 1 } };
}

// At most Diagnostic::element_limit vertices on damped hinges, as numbered in the files.
std::vector<std::uint32_t> foldover_vertices(const DiscreteShells& shells, const PoseSet& poses)
{
    std::vector<std::uint32_t> out;
    for (const std::size_t hinge : shells.foldover_hinges()) {
        if (out.size() >= Diagnostic::element_limit) break;
        std::size_t count = 0;
        const std::uint32_t* vertices = shells.element_vertices(hinge, count); // the edge, then what is opposite
        for (std::size_t i = 0; i < 2; ++i) out.push_back(poses.file_number(vertices[i]));
    }
    return out;
}

InputReport describe(const PoseSet& poses, const NormalizedPoses& set, const Energy& energy)
{
    InputReport report;
    report.vertex_count = std::size_t(set.dof_count() / 3);
    report.tet_count = set.tets.size();
    report.pose_count = set.pose_count();
    report.repairs = poses.repairs;
    report.is_aligned = set.is_free() && set.frame.size() == 0;
    if (poses.render_mesh) {
        report.drawn_vertex_count = poses.render_mesh->embedding.count();
        report.drawn_triangle_count = poses.render_mesh->triangles.size();
    }
    for (std::uint32_t v : set.fixed_vertices) report.fixed_vertices.push_back(poses.file_number(v));
    std::sort(report.fixed_vertices.begin(), report.fixed_vertices.end());
    if (const auto* shells = dynamic_cast<const DiscreteShells*>(&without_ties(energy))) {
        report.foldover_count = shells->foldover_hinges().size();
        report.foldover_vertices = foldover_vertices(*shells, poses);
    }
    if (const auto* shells = dynamic_cast<const ReinforcedShells*>(&without_ties(energy))) {
        report.rough_count = shells->rough_count();
        report.roughest_vertex = poses.file_number(shells->roughest_vertex());
    }
    return report;
}

// All branches, with vertices as numbered in the files.
std::vector<Branch> all_branches(const AverageFamily& family, const CheckedAsset& checked, const PoseSet& poses)
{
    std::vector<Branch> branches = family.branches();
    branches.insert(branches.end(), checked.branches.begin(), checked.branches.end());
    for (Branch& branch : branches) branch.vertex = poses.file_number(branch.vertex);
    return branches;
}

// The bytes with their certificate. Throws Failure if the runtime does not open them.
std::vector<std::uint8_t> encode_certified(const CheckedAsset& checked, const std::string& certificate)
{
    AssetRecord record = checked.record;
    record.certificate = certificate;
    std::vector<std::uint8_t> bytes = encode_asset(checked.asset, record);
    constexpr bool verify_checksums = true;
    const RuntimeBlender opened(bytes, "the asset just baked", verify_checksums);
    return bytes;
}

} // namespace

BakedAsset bake(const PoseSet& poses, const BakeOptions& given, Progress& listener)
{
    PlannedProgress progress(listener, plan_stages());
    const BakeOptions options = resolve_options(given, poses);
    warn_of_memory(estimate_bake(poses, options).memory, available_memory(), progress);
    BakeReport report;
    Stopwatch watch;
    const TimeBudget budget(options.time_limit);
    progress.update("poses", 0);
    const NormalizedPoses set = normalize_poses(poses, options.energy, progress);
    const WeightDomain domain = domain_of(options, poses);
    const ElasticModel model = make_model(set, options.energy, &progress);
    const Energy& energy = *model.energy;
    report.input = describe(poses, set, energy);
    report.input.material = *options.energy.material;
    report.input.ranges = domain.ranges();
    report.input.pose_names = poses.names;
    warn_of_foldover(report.input, options.energy, progress);
    SolverPool pool(energy, set, options.energy.solver);
    watch.end_stage("poses");

    // By continuation from every pose, or from the first one where nothing is to be refined.
    const std::optional<std::size_t> start_pose = budget.is_spent() ? std::optional<std::size_t>(0) : std::nullopt;
    AverageFamily family(pool, average_options(options, set), &progress, start_pose, model.coarse.get());
    family.mean();
    report.start_pose = family.start_pose();
    watch.end_stage("mean");

    const FoundFamily known = find_subspace(family, domain, options, budget, progress);
    const FoundSubspace& found = known.found;
    report.snapshot_count = found.averages.size() - found.interpolated_count();
    report.interpolated_count = found.interpolated_count();
    report.unconverged_snapshot_count = found.unconverged_count;
    watch.end_stage("subspace");

    const FitProblem problem { set, energy, family, *known.source, found, budget, domain };
    const FittedModel fitted = fit(problem, options, progress);
    report.fit = fitted.report;
    watch.end_stage(name_of(fitted.report.kind));

    const CheckedAsset checked = self_check({ poses, problem, fitted, pool }, options, progress);
    report.check = checked.report;
    report.branches = all_branches(family, checked, poses);
    report.factorization_count = pool.factorization_count();
    if (report.check.ties) use_file_numbers(poses.source_vertices, *report.check.ties);
    warn_of_blends(report, poses, progress);
    report.certificate = write_certificate(report, options, poses.names);
    std::vector<std::uint8_t> bytes = encode_certified(checked, report.certificate);
    watch.end_stage("check");
    progress.update("check", 1);
    report.stages = watch.stages();
    return { std::move(bytes), std::move(report) };
}

} // namespace pliant
