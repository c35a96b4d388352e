#include "bake/bake.h"

#include "bake/certificate.h"
#include "bake/self_check.h"
#include "bake/verdict.h"
#include "base/common/diagnostics.h"
#include "base/common/parallel.h"
#include "base/mesh/smoothing_groups.h"
#include "base/mesh/tets.h"
#include "elastic/average/family.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/average/sweep.h"
#include "elastic/energy/arap.h"
#include "elastic/energy/solid.h"
#include "elastic/parts/calibrate_ties.h"
#include "elastic/parts/find_ties.h"
#include "elastic/parts/tied_energy.h"
#include "output/asset/asset_writer.h"
#include "output/asset/runtime_blender.h"
#include "pliant_format.h"
#include "reduced/subspace/barbic.h"
#include "reduced/subspace/krylov.h"
#include "reduced/surrogate/ghost.h"

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/core.h>
#include <iterator>

namespace pliant {

namespace {

// Wall-clock time of each stage, for the report.
class Stopwatch {
public:
    explicit Stopwatch(std::vector<StageTime>& stages)
        : stages_(stages)
    {
    }
    void stage_done(const std::string& stage)
    {
        const auto now = std::chrono::steady_clock::now();
        stages_.push_back({ stage, std::chrono::duration<double>(now - last_).count() });
        last_ = now;
    }

private:
    std::vector<StageTime>& stages_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// The runtime's problem with what it lives on: a ghost has a mesh and an energy of its own.
struct BuiltModel {
    std::unique_ptr<Ghost> ghost;
    std::unique_ptr<Energy> ghost_energy;
    BlendModel model;

    // Shape of the stand-in's mesh at q.
    Shape shape(const Subspace& subspace, const Eigen::VectorXd& q) const
    {
        return ghost ? Shape(ghost->set.shapes[0] + ghost->basis * q) : subspace.shape(q);
    }
};

// The runtime holds at most this many dimensions (formats/SPEC.md); an adaptive basis stops at a quarter of it, where frames stay cheap.
constexpr Eigen::Index format_dimension_limit = 256;

constexpr double default_tolerance = 1e-3;

// Truths are wanted to this part of the tolerance.
constexpr double truth_share = 0.05;

// For snapshots and checks: what counts is the distance between shapes, to a few per cent of the error that is looked for. The
// decrement is tested before the last step, which squares it. Where the truth snaps, Newton creeps: an almost converged average is as
// good a snapshot, and the report counts it.
NewtonOptions truth_options(const BakeOptions& options, const ShapeSet& set)
{
    NewtonOptions newton;
    // Below the default tolerance the energy has to say more, too: it goes with the square of what is off.
    newton.decrement = 1e-5 * std::clamp(std::pow(options.tolerance / default_tolerance, 2), 1e-8, 1.0);
    newton.residual = 3e-2;
    newton.step_ratio = 0.05;
    newton.step_floor = truth_share * options.tolerance * mass_norm(set.shapes[0], set.masses); // shapes are centred
    newton.max_iterations = 15;
    return newton;
}

// Fills the simplex more or less evenly; for two poses a line.
std::size_t training_count(std::size_t pose_count)
{
    const std::size_t counts[] = { 33, 80, 128, 160, 192 };
    return pose_count < 7 ? counts[std::max<std::size_t>(pose_count, 2) - 2] : 256;
}

AdaptiveSubspace make_subspace(AverageFamily& family, SolverPool& pool, const BakeOptions& options, Progress& progress,
                               BakeReport& report)
{
    const std::size_t m = pool.set().pose_count();
    const std::vector<Weights> check_weights = draw_weights(options.seed + 1000003, m, options.check_count);
    const KnownAverage mean { equal_weights(m), family.mean().y };
    if (options.subspace == SubspaceKind::adaptive) {
        AdaptiveOptions adaptive;
        adaptive.dimension = options.dimension;
        adaptive.seed = options.seed;
        return build_adaptive_subspace(family, mean, training_weights(m, training_count(m), options.seed), check_weights,
                                       adaptive, &progress, report.adaptive);
    }
    AdaptiveSubspace out;
    out.subspace = options.subspace == SubspaceKind::krylov
        ? build_krylov_subspace(pool.at(0), { options.ritz_count, options.dimension, format_dimension_limit }, &progress)
        : build_barbic_subspace(pool.at(0), { BarbicOptions().mode_count, options.dimension, format_dimension_limit },
                                &progress);
    out.checks = sweep(family, { mean }, check_weights, &progress);
    return out;
}

StandInOptions stand_in_options(const BakeOptions& options)
{
    return { options.tolerance, options.tolerance_max, options.element_count, options.seed, options.cubature_solver };
}

BuiltModel build_ghost(const ShapeSet& set, const ReducedEnergy& reduced, const TrainingSet& training,
                       const std::vector<CheckPoint>& checks, const BakeOptions& options, Progress& progress,
                       StandInReport& report)
{
    progress.update("ghost", 0);
    BuiltModel built;
    built.ghost = std::make_unique<Ghost>(make_ghost(set, reduced.subspace(), options.ghost_vertex_count));
    built.ghost_energy = make_energy(built.ghost->set, options.energy);
    std::vector<std::size_t> elements(built.ghost_energy->element_count());
    for (std::size_t i = 0; i < elements.size(); ++i) elements[i] = i;
    auto stand_in = std::make_shared<const StandIn>(*built.ghost_energy, built.ghost->set.shapes[0], built.ghost->basis,
                                                    elements, Eigen::VectorXd::Ones(Eigen::Index(elements.size())));
    built.model = fit_model(stand_in, reduced.subspace(), set, training, checks, false, stand_in_options(options), report);
    return built;
}

// Of the kind that options.stand_in says. `quartic`: of at least as many dimensions, where it is that.
BuiltModel build_model(const ShapeSet& set, const ReducedEnergy& reduced, const TrainingSet& training,
                       const std::vector<CheckPoint>& checks, const Quartic* quartic, const BakeOptions& options,
                       Progress& progress, StandInReport& report)
{
    if (options.stand_in == StandInKind::ghost)
        return build_ghost(set, reduced, training, checks, options, progress, report);
    BuiltModel built;
    const StandInOptions wanted = stand_in_options(options);
    if (!quartic) {
        built.model = choose_cubature(reduced, set, training, checks, wanted, &progress, report);
        return built;
    }
    const Subspace& subspace = reduced.subspace();
    auto stand_in = std::make_shared<const StandIn>(reduced.energy(), quartic->leading(subspace.dimension()));
    built.model = fit_model(std::move(stand_in), subspace, set, training, checks, false, wanted, report);
    return built;
}

// All that depends on the dimension.
struct Fitted {
    Subspace subspace;
    TrainingSet training;
    BuiltModel built;
    StandInReport stand_in;
};

// Being off by the tolerance may cost this part of the energy of the mean; what would cost less follows the true average, what would
// cost more the energy (training_of). With a much larger part training shapes get creased.
constexpr double nearness_share = 0.003;

double nearness_wanted(const ShapeSet& set, double mean_energy, double tolerance)
{
    const double off = tolerance * mass_norm(set.shapes[0], set.masses); // shapes are centred
    return 2 * nearness_share * std::max(mean_energy, 1e-13) / (off * off);
}

// What a fit works on, whatever the dimension.
struct FitProblem {
    const Energy& energy;
    AverageFamily& family;
    const ShapeSet& set;
    const AdaptiveSubspace& found;
    std::vector<ProjectedAverage> averages;
};

Fitted fit(const FitProblem& p, Eigen::Index d, const Quartic* quartic, const BakeOptions& options, Progress& progress)
{
    Fitted out;
    out.subspace = leading(p.found.subspace, d);
    const double mean_energy = p.family.mean().energy;
    const ReducedSolver reduced(p.energy, out.subspace, p.family.mean_hessian(), mean_energy);
    const std::size_t m = p.set.pose_count();
    out.training = p.averages.empty()
        ? solve_training_set(reduced, p.set, training_weights(m, training_count(m), options.seed), &progress)
        : training_of(reduced, p.averages, nearness_wanted(p.set, mean_energy, options.tolerance));
    out.built = build_model(p.set, reduced.energy(), out.training, p.found.checks, quartic, options, progress, out.stand_in);
    return out;
}

// Fewer dimensions than it takes to hold the checks themselves to the tolerance need not be tried.
Eigen::Index least_dimension(const ShapeSet& set, const AdaptiveSubspace& found, double tolerance)
{
    const Eigen::Index most = found.subspace.dimension();
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(most + 1); // distance of the truths from the first d dimensions
    for (const CheckPoint& check : found.checks) {
        const Eigen::VectorXd q = project(found.subspace, check.truth, set.masses);
        double rest = std::pow(mass_norm(check.truth - found.subspace.shape(q), set.masses), 2);
        for (Eigen::Index d = most; d >= 0; --d) {
            mean[d] += std::sqrt(rest) / mass_norm(check.truth, set.masses) / double(found.checks.size());
            if (d > 0) rest += q[d - 1] * q[d - 1];
        }
    }
    Eigen::Index d = Eigen::Index(set.pose_count()) - 1;
    while (d < most && mean[d] > tolerance) ++d;
    return std::min(d, most);
}

// An adaptive subspace holds more dimensions than it may need: as few of at most `most` as keep the tolerance.
Fitted fit_least(const FitProblem& p, Eigen::Index most, const Quartic* quartic, const BakeOptions& options,
                 Progress& progress)
{
    if (p.averages.empty() || options.dimension || p.found.checks.empty()) return fit(p, most, quartic, options, progress);
    Fitted out;
    const Eigen::Index least = std::min(most, least_dimension(p.set, p.found, options.tolerance));
    choose_dimension(least, most, stand_in_options(options), [&](Eigen::Index d) {
        progress.update("dimension", 0, fmt::format("d = {}", d));
        out = fit(p, d, quartic, options, progress);
        return out.stand_in.error();
    });
    return out;
}

// Exactness is worth a frame that costs twice as much as one with cubature, as it does here (runtime/README.md), and not many times as
// much: the table grows with the fourth power of the dimension.
constexpr Eigen::Index quartic_dimension_wanted = 32;

// Whether `auto` tries the quartic, and why not.
bool wants_quartic(const FitProblem& p, const BakeOptions& options, BakeReport& report)
{
    const auto* solid = dynamic_cast<const Solid*>(&p.energy);
    if (options.stand_in == StandInKind::quartic) return true;
    if (options.stand_in != StandInKind::automatic || !solid || solid->law() != SolidLaw::stvk) return false;
    const Eigen::Index most = p.found.subspace.dimension();
    const bool is_free = !p.averages.empty() && !options.dimension && !p.found.checks.empty();
    const Eigen::Index least = is_free ? least_dimension(p.set, p.found, options.tolerance) : most;
    if (least <= quartic_dimension_wanted) return true;
    report.stand_in_reason = fmt::format("d = {} at least, and above {} a quartic is much slower than cubature", least,
                                         quartic_dimension_wanted);
    return false;
}

Fitted choose_and_fit(const FitProblem& p, BakeOptions options, Progress& progress, BakeReport& report)
{
    const Eigen::Index all = p.found.subspace.dimension();
    if (wants_quartic(p, options, report)) {
        const bool is_asked = options.stand_in == StandInKind::quartic;
        const Eigen::Index most
            = std::min<Eigen::Index>(all, is_asked ? PLIANT_FORMAT_MAX_QUARTIC_DIMENSION : quartic_dimension_wanted);
        const Quartic quartic(dynamic_cast<const Solid&>(p.energy), leading(p.found.subspace, most), &progress);
        Fitted out = fit_least(p, most, &quartic, options, progress);
        report.stand_in_kind = StandInKind::quartic;
        if (is_asked || most == all || out.stand_in.error().mean <= options.tolerance) return out;
        report.stand_in_reason
            = fmt::format("at d = {} the tolerance is not kept, and above it a quartic is much slower", most);
    }
    if (options.stand_in != StandInKind::ghost) options.stand_in = StandInKind::cubature;
    report.stand_in_kind = options.stand_in;
    return fit_least(p, all, nullptr, options, progress);
}

// Families that are not smooth are said, never smoothed over.
void tell_findings(const BakeReport& report, const PoseSet& poses, const EnergyOptions& energy, Progress& progress)
{
    for (const BranchFinding& finding : report.findings) {
        const std::string& pose = poses.names[finding.pose];
        const std::string what = finding.kind == BranchFinding::Kind::other_mean
            ? fmt::format("seen from pose {}, the average of all poses is another one", pose)
            : finding.kind == BranchFinding::Kind::jump ? fmt::format("the average jumps on the way towards pose {}", pose)
                                                        : fmt::format("there are two averages towards pose {}", pose);
        progress.warn(4406,
                      fmt::format("{}: {:.1f} % away, most at vertex {}, weights {}", what, 100 * finding.distance,
                                  finding.vertex, weights_text(finding.weights)),
                      hint_for_jumps(energy, poses.is_solid()));
    }
}

void tell_inversion(const BakeReport& report, Progress& progress)
{
    if (!report.tet_count || report.checks.empty() || report.cell_ratio > 0) return;
    progress.warn(4407, fmt::format("blends have tetrahedra inside out (smallest J {:.3f})", report.cell_ratio),
                  "use --material mooney-rivlin, or add a pose in between");
}

void tell_fit(const Fitted& fitted, Progress& progress, BakeReport& report)
{
    report.dimension = fitted.subspace.dimension();
    report.stand_in = fitted.stand_in;
    report.element_count = fitted.built.model.stand_in->element_count();
    report.training_count = fitted.training.weights.size();
    report.unconverged_training_count = fitted.training.unconverged_count;
    if (fitted.stand_in.curvature.lowest <= 0)
        progress.warn(4402,
                      fmt::format("the stand-in is not convex at all training weights (lowest curvature {:.3g})",
                                  fitted.stand_in.curvature.lowest),
                      "raise --elements, or add an in-between pose");
}

// A stand-in that the material does not have is a wrong command line.
void check_stand_in(const BakeOptions& options, const PoseSet& poses)
{
    const Material material = *options.energy.material;
    const bool is_solid = material == Material::stvk || material == Material::mooney_rivlin;
    if (options.stand_in == StandInKind::quartic && material != Material::stvk)
        throw Failure(ExitCode::usage,
                      error_at(1207, "", fmt::format("--energy quartic needs --material stvk, not {}", name_of(material)),
                               "leave it out, or use --energy cubature"));
    if (options.stand_in == StandInKind::ghost && is_solid)
        throw Failure(ExitCode::usage,
                      error_at(1208, "", "--energy ghost is for surfaces, the poses are solids",
                               "leave it out, or use --energy cubature"));
    if (options.stand_in == StandInKind::ghost) // before the minutes that come before the ghost
        require_manifold(poses.triangles, poses.vertex_count(), poses.source_vertices, "--energy ghost",
                         "repair it alike in all poses, or use --energy cubature, which needs none");
}

void describe(BakeReport& report, const PoseSet& poses, const ShapeSet& set, const Energy& energy)
{
    report.tet_count = set.tets.size();
    report.repairs = poses.repairs;
    if (poses.drawn) {
        report.drawn_vertex_count = poses.drawn->embedding.count();
        report.drawn_triangle_count = poses.drawn->triangles.size();
    }
    for (std::uint32_t v : set.fixed_vertices) report.fixed_vertices.push_back(poses.file_number(v));
    std::sort(report.fixed_vertices.begin(), report.fixed_vertices.end());
    report.vertex_count = std::size_t(set.dof_count() / 3);
    report.pose_count = set.pose_count();
    if (const auto* shells = dynamic_cast<const DiscreteShells*>(&without_ties(energy))) {
        report.foldover_count = shells->foldover_hinges().size();
        for (const std::size_t hinge : shells->foldover_hinges()) {
            if (report.foldover_vertices.size() >= Finding::element_limit) break;
            std::size_t count = 0;
            const std::uint32_t* vertices = shells->element_vertices(hinge, count); // the edge, then what is opposite
            for (std::size_t i = 0; i < 2; ++i) report.foldover_vertices.push_back(poses.file_number(vertices[i]));
        }
    }
    if (const TieSet* ties = ties_of(energy)) report.ties = start_tie_report(*ties, set);
}

// Welded vertices share a normal unless the file's own normals say that there is an edge.
std::vector<std::uint32_t> smoothing_of(const DrawnSurface& drawn, const RenderScene* scene)
{
    std::vector<std::uint32_t> welded;
    for (const Tetrahedron& corners : drawn.embedding.corners) welded.push_back(corners[0]);
    std::vector<Eigen::Vector3d> normals;
    const VertexAttribute* given = scene && scene->vertex_count == welded.size() ? scene->find("NORMAL") : nullptr;
    for (std::size_t v = 0; given && v < welded.size(); ++v)
        normals.push_back(Eigen::Map<const Eigen::Vector3f>(given->values.data() + 3 * v).cast<double>());
    return smoothing_groups(welded, normals);
}

} // namespace

Material material_for(const EnergyOptions& options, bool is_solid)
{
    const Material material = options.material.value_or(is_solid ? Material::stvk : Material::discrete_shells);
    const bool is_of_solids = material == Material::stvk || material == Material::mooney_rivlin;
    if (is_of_solids != is_solid)
        throw Failure(ExitCode::usage,
                      error_at(1206, "",
                               fmt::format("--material {} is for {}, the poses are {}", name_of(material),
                                           is_of_solids ? "solids" : "surfaces", is_solid ? "solids" : "surfaces"),
                               is_solid ? "solids are stvk or mooney-rivlin" : "surfaces are discrete-shells or arap"));
    return material;
}

std::unique_ptr<Energy> make_energy(const ShapeSet& set, const EnergyOptions& options, Progress* progress)
{
    switch (material_for(options, set.is_solid())) {
    case Material::arap: return std::make_unique<Arap>(set);
    case Material::stvk: return std::make_unique<Solid>(set, SolidOptions { SolidLaw::stvk, options.poisson });
    case Material::mooney_rivlin:
        return std::make_unique<Solid>(set, SolidOptions { SolidLaw::mooney_rivlin, options.poisson });
    default: break;
    }
    std::unique_ptr<Energy> energy = tie_parts(std::make_unique<DiscreteShells>(set, options.shell), find_ties(set));
    if (auto* tied = dynamic_cast<TiedEnergy*>(energy.get())) settle_ties(*tied, set, options.solver, progress);
    return energy;
}

BakedAsset bake(const PoseSet& poses, const BakeOptions& given, Progress& progress)
{
    BakeOptions options = given;
    options.energy.material = material_for(given.energy, poses.is_solid());
    check_stand_in(options, poses);
    BakedAsset out;
    BakeReport& report = out.report;
    Stopwatch watch(report.stages);
    progress.update("poses", 0);
    const ShapeSet set = normalise(poses, options.energy.keep_placement);
    const std::unique_ptr<Energy> energy = make_energy(set, options.energy, &progress);
    describe(report, poses, set, *energy);
    if (report.foldover_count)
        progress.warn(
            4403,
            fmt::format("{} hinges are folded over or fold strongly between poses; their bending is multiplied by {}",
                        report.foldover_count, options.energy.shell.foldover_damping),
            "smooth the creases there, or set --foldover-damping (1 = off)");
    SolverPool pool(*energy, set, options.energy.solver);
    watch.stage_done("poses");

    AverageFamily family(pool, truth_options(options, set), &progress);
    family.mean();
    report.start_pose = family.start_pose();
    report.findings = family.findings();
    watch.stage_done("mean");

    AdaptiveSubspace found = make_subspace(family, pool, options, progress, report);
    watch.stage_done("subspace");

    const Fitted fitted = choose_and_fit(
        { *energy, family, set, found, project_averages(*energy, found.subspace, set, found.averages, &progress) }, options,
        progress, report);
    tell_fit(fitted, progress, report);
    watch.stage_done(name_of(report.stand_in_kind));
    const Subspace& subspace = fitted.subspace;
    const BuiltModel& built = fitted.built;
    report.subspace_error
        = subspace_error(ReducedSolver(*energy, subspace, family.mean_hessian(), family.mean().energy), set, found.checks);

    AssetModel asset;
    asset.set = &set;
    asset.subspace = &subspace;
    asset.stand_in = built.model.stand_in.get();
    asset.stand_in_reference = built.shape(subspace, built.model.mean);
    asset.mean = built.model.mean;
    asset.root = built.model.root;
    asset.energy_scale = built.model.energy_scale;
    asset.predictor = built.model.predictor;
    asset.load = built.model.load;
    asset.names = poses.names;
    asset.polygons = poses.drawn ? nullptr : &poses.polygons; // those name drawn vertices, as drawn->polygons will
    asset.source_vertices = poses.is_solid() ? &poses.source_vertices : nullptr;
    asset.boundary_vertex_count = poses.boundary_vertex_count;

    const Eigen::MatrixXd reachable = reachable_coordinates(subspace, fitted.training);
    // Vertices that are held stay where they are to the bit, which sums of rounded numbers would not keep.
    const double position_error = set.is_free() ? options.position_error * set.diagonal : 0;
    StoredShape stored = store_shape(set, subspace, nullptr, reachable, position_error);
    asset.stored = &stored;
    asset.certificate = "{}"; // written last

    collect_answers(asset, built.model, fitted.training, report);
    check_asset(encode_asset(asset), family, pool, found.checks, options, progress, report);
    report.factorization_count = pool.factorization_count();
    for (BranchFinding& finding : report.findings) finding.vertex = poses.file_number(finding.vertex);
    const DrawnSurface* drawn = options.drawn ? options.drawn.get() : poses.drawn.get();
    std::vector<std::uint32_t> smoothing;
    if (drawn) { // the coordinates may be others: what single precision does as well stays in it
        asset.drawn = drawn;
        stored = store_shape(set, subspace, &drawn->embedding, reachable, position_error);
        collect_answers(asset, built.model, fitted.training, report);
    }
    // Welded vertices are rows of the elastic ones, so what was found at these holds there, too.
    if (options.drawn)
        report.drawn = check_drawn(encode_asset(asset), set, *options.drawn, found.checks);
    else if (drawn)
        smoothing = smoothing_of(*drawn, poses.scene.get());
    if (!smoothing.empty()) asset.smoothing = &smoothing;
    const std::vector<std::uint8_t> drawn_bytes = encode_asset(asset);
    RuntimeBlender blender(drawn_bytes, "the asset just baked");
    asset.morph_ranges = find_morph_ranges(blender);
    report.basis = check_basis(asset, reachable);
    tell_findings(report, poses, options.energy, progress);
    tell_inversion(report, progress);
    if (report.ties) {
        use_file_numbers(poses.source_vertices, *report.ties);
        tell_ties(*report.ties, drift_limit, progress);
    }
    if (options.keep_scene) asset.scene = poses.scene.get();
    report.certificate = write_certificate(report, options, poses.names);
    asset.certificate = report.certificate;
    out.bytes = encode_asset(asset);
    RuntimeBlender(out.bytes, "the asset just baked", true);
    watch.stage_done("check");
    return out;
}

BakeEstimate estimate_bake(std::size_t vertex_count, std::size_t pose_count, const BakeOptions& options)
{
    const double n = double(vertex_count), m = double(pose_count);
    const bool is_adaptive = options.subspace == SubspaceKind::adaptive;
    BakeEstimate estimate {};
    // The adaptive dimension depends on the poses: about four per pair, found on bodies in very different poses (fewer when they are alike).
    const double expected
        = is_adaptive ? std::min(64.0, 4 * m * (m - 1) / 2) : (m - 1) + m * (m - 1) * (1 + options.ritz_count);
    estimate.dimension = Eigen::Index(options.dimension ? double(options.dimension) : std::min(expected, 256.0));
    const double d = double(estimate.dimension);
    // Orders of magnitude from the runs in tests/bench: seconds of a factorisation with its Hessian, and of a reduced gradient.
    const double factorisation = 0.6 * std::pow(n / 1e4, 1.3), gradient = 1.5e-6 * n * (1 + d / 60);
    const double averages = double(training_count(pose_count)) + double(options.check_count);
    const double factorisations = is_adaptive ? 25 * m + 8 * averages : m + 15 * double(options.check_count);
    const double solves = double(options.check_count) + (is_adaptive ? 0 : double(training_count(pose_count)));
    estimate.seconds = (factorisations + 20.0 * options.fresh_count) * factorisation + solves * 20 * gradient + d * d * 1e-2;
    // Factor and Hessian of every thread, all averages three times over while their directions are found, a few copies of the basis.
    estimate.memory = 18e3 * n * double(worker_count()) + 24 * n * (5 * d + (is_adaptive ? 3 * averages : 0));
    estimate.asset_size = 12 * n * (d + 1) + 24 * n;
    return estimate;
}

} // namespace pliant
