#include "bake.h"

#include "average/family.h"
#include "average/rigid_modes.h"
#include "energy/arap.h"
#include "reduce/ghost.h"
#include "report/certificate.h"
#include "report/diagnostics.h"
#include "subspace/barbic.h"
#include "subspace/krylov.h"
#include "write/asset_writer.h"
#include "write/runtime_blender.h"

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/core.h>

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

// The stand-in with what it lives on: a ghost has a mesh and an energy of its own.
struct BuiltStandIn {
    std::unique_ptr<Ghost> ghost;
    std::unique_ptr<Energy> ghost_energy;
    std::unique_ptr<StandIn> stand_in;

    // Shape of the stand-in's mesh at q.
    Shape shape(const Subspace& subspace, const Eigen::VectorXd& q) const
    {
        return ghost ? Shape(ghost->set.shapes[0] + ghost->basis * q) : subspace.shape(q);
    }
};

// The runtime holds at most this many dimensions (formats/SPEC.md); an adaptive basis stops at a quarter of it, where frames stay cheap.
constexpr Eigen::Index format_dimension_limit = 256;

Subspace choose_subspace(NewtonSolver& solver, const BakeOptions& options, Progress& progress, BakeReport& report)
{
    if (options.subspace == SubspaceKind::krylov)
        return build_krylov_subspace(solver, { options.ritz_count, options.dimension, format_dimension_limit }, &progress);
    if (options.subspace == SubspaceKind::barbic)
        return build_barbic_subspace(solver, { BarbicOptions().mode_count, options.dimension, format_dimension_limit },
                                     &progress);
    AdaptiveOptions adaptive;
    adaptive.tolerance = options.tolerance;
    adaptive.dimension = options.dimension;
    adaptive.seed = options.seed;
    return build_adaptive_subspace(solver, adaptive, &progress, report.adaptive);
}

BuiltStandIn build_stand_in(const ShapeSet& set, const ReducedEnergy& reduced, const TrainingSet& training,
                            const BakeOptions& options, Progress& progress, BakeReport& report)
{
    BuiltStandIn built;
    if (options.stand_in == StandInKind::cubature) {
        CubatureOptions cubature;
        cubature.element_count = options.element_count;
        cubature.seed = options.seed;
        built.stand_in = std::make_unique<StandIn>(fit_cubature(reduced, training, cubature, &progress, report.cubature));
        return built;
    }
    progress.update("ghost", 0);
    built.ghost = std::make_unique<Ghost>(make_ghost(set, reduced.subspace(), options.ghost_vertex_count));
    built.ghost_energy = make_energy(built.ghost->set, options.energy);
    std::vector<std::size_t> elements(built.ghost_energy->element_count());
    for (std::size_t i = 0; i < elements.size(); ++i) elements[i] = i;
    built.stand_in
        = std::make_unique<StandIn>(*built.ghost_energy, built.ghost->set.shapes[0], built.ghost->basis, std::move(elements),
                                    Eigen::VectorXd::Ones(Eigen::Index(built.ghost_energy->element_count())));
    measure_curvature(*built.stand_in, training, report.cubature.lowest_curvature, report.cubature.highest_curvature);
    return built;
}

// The minimiser of the stand-in at w, from the training average nearest in weights.
Eigen::VectorXd solve_stand_in(const StandIn& stand_in, const TrainingSet& training, const Weights& w,
                               const Eigen::MatrixXd& metric, double scale)
{
    std::size_t nearest = 0;
    for (std::size_t t = 1; t < training.weights.size(); ++t)
        if ((training.weights[t] - w).norm() < (training.weights[nearest] - w).norm()) nearest = t;
    MinimiseOptions options;
    options.tolerance = 1e-6;
    options.scale = scale;
    return minimise([&](const Eigen::VectorXd& q, Eigen::VectorXd& g) { return stand_in.gradient(w, q, g); },
                    training.averages[nearest], metric, options)
        .q;
}

// Fits z0(w) to the stand-in's own minimisers, so that the solver starts where it will end; poses are exact.
Predictor fit_warm_start(const StandIn& stand_in, const TrainingSet& training, const AssetModel& model, std::uint64_t seed,
                         Progress& progress)
{
    const std::size_t m = std::size_t(training.weights[0].size());
    const Eigen::MatrixXd metric = model.root * model.root.transpose();
    const Eigen::PartialPivLU<Eigen::MatrixXd> to_z(model.root);
    std::vector<Weights> centres = training.weights;
    Random random(seed + 17);
    if (m > 2)
        for (int i = 0; i < 40; ++i) centres.push_back(random.weights(m, i % 2 == 0));
    const std::size_t inner_count = centres.size();
    for (std::size_t k = 0; k < m; ++k) centres.push_back(corner_weights(m, k));
    Eigen::MatrixXd values(model.root.cols(), Eigen::Index(centres.size()));
    for (std::size_t i = 0; i < centres.size(); ++i) {
        progress.update("warm start", double(i) / double(centres.size()));
        const Eigen::VectorXd q = i < inner_count
            ? solve_stand_in(stand_in, training, centres[i], metric, model.energy_scale)
            : Eigen::VectorXd(model.subspace->pose_coordinates.col(Eigen::Index(i - inner_count)));
        values.col(Eigen::Index(i)) = to_z.solve(q - model.mean);
    }
    return fit_predictor(centres, values);
}

// Coordinates in which the solver works: around the stand-in's own mean, whitened by its Hessian there.
void fit_coordinates(const BuiltStandIn& built, const TrainingSet& training, AssetModel& model, BakeReport& report,
                     Progress& progress)
{
    const StandIn& stand_in = *built.stand_in;
    const MinimiseResult mean = minimise_newton(stand_in, training.weights[0], training.averages[0], 1e-8, 100);
    double lowest = 0;
    model.mean = mean.q;
    model.root = inverse_root(stand_in.hessian(training.weights[0], mean.q, HessianKind::exact), metric_floor, &lowest);
    if (!mean.has_converged || lowest <= 0 || report.cubature.lowest_curvature <= 0)
        progress.warn(4402,
                      fmt::format("the stand-in is not convex at all training weights (lowest curvature {:.3g})",
                                  report.cubature.lowest_curvature),
                      "raise --elements, or add an in-between pose");
    double energy = 0;
    for (std::size_t t = 0; t < training.weights.size(); ++t)
        energy += stand_in.value(training.weights[t], training.averages[t]);
    model.energy_scale = energy / double(training.weights.size());
    model.stand_in_reference = built.shape(*model.subspace, mean.q);
}

std::vector<float> to_floats(const Weights& w)
{
    const Eigen::VectorXf f = w.cast<float>();
    return std::vector<float>(f.data(), f.data() + f.size());
}

// The runtime's answers: at the mean, at edge mid-points and between. They go into the asset as its own test, and are compared with
// the double-precision stand-in.
void collect_answers(AssetModel& model, const TrainingSet& training, BakeReport& report)
{
    RuntimeBlender blender(encode_asset(model), "the asset just baked"),
        tight = RuntimeBlender(encode_asset(model), "the same");
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.tolerance = 1e-5f; // to compare the arithmetic, not the stopping rule
    tight.configure(desc);
    const Eigen::MatrixXd metric = model.root * model.root.transpose();
    const std::size_t count = std::min<std::size_t>(training.weights.size(), 8);
    for (std::size_t t = 0; t < count; ++t) {
        const std::vector<float> w = to_floats(training.weights[t]), q = blender.solve(w, false),
                                 fine = tight.solve(w, false);
        model.answers.push_back(
            { training.weights[t], Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size())) });
        const Eigen::VectorXd exact
            = solve_stand_in(*model.stand_in, training, training.weights[t], metric, model.energy_scale);
        const Eigen::VectorXd found
            = Eigen::Map<const Eigen::VectorXf>(fine.data(), Eigen::Index(fine.size())).cast<double>();
        // U is mass-orthonormal and the mass is 1: distances in q are distances of shapes.
        const double size = mass_norm(model.subspace->shape(exact), model.set->masses);
        report.stand_in_error = std::max(report.stand_in_error, (found - exact).norm() / size);
    }
}

// Blends of the finished asset against the unreduced average that Newton finds from them.
void check_against_unreduced(const std::vector<std::uint8_t>& bytes, NewtonSolver& solver, const BakeOptions& options,
                             Progress& progress, BakeReport& report)
{
    RuntimeBlender blender(bytes, "the asset just baked");
    Random random(options.seed + 1000003); // other weights than the ones trained on
    for (int i = 0; i < options.check_count; ++i) {
        progress.update("check", double(i) / options.check_count,
                        fmt::format("unreduced average {} of {}", i + 1, options.check_count));
        const Weights w = random.weights(solver.set().pose_count(), i % 3 == 2);
        const Shape blend = from_input_units(solver.set(), blender.positions(blender.solve(to_floats(w), false)));
        const NewtonResult truth = solver.minimise(w, blend, NewtonOptions());
        if (!truth.has_converged) ++report.unconverged_check_count;
        report.checks.push_back({ w, shape_error(solver.energy(), solver.set(), w, blend, truth.y) });
    }
}

void describe(BakeReport& report, const ShapeSet& set, const Energy& energy)
{
    report.vertex_count = std::size_t(set.dof_count() / 3);
    report.pose_count = set.pose_count();
    if (const auto* shells = dynamic_cast<const DiscreteShells*>(&energy))
        report.foldover_count = shells->foldover_hinges().size();
}

} // namespace

std::unique_ptr<Energy> make_energy(const ShapeSet& set, const EnergyOptions& options)
{
    if (options.material == Material::arap) return std::make_unique<Arap>(set);
    return std::make_unique<DiscreteShells>(set, options.shell);
}

BakedAsset bake(const PoseSet& poses, const BakeOptions& options, Progress& progress)
{
    BakedAsset out;
    BakeReport& report = out.report;
    Stopwatch watch(report.stages);
    progress.update("poses", 0);
    const ShapeSet set = normalise(poses, options.energy.keep_placement);
    const std::unique_ptr<Energy> energy = make_energy(set, options.energy);
    describe(report, set, *energy);
    if (report.foldover_count)
        progress.warn(
            4403,
            fmt::format("{} hinges are folded over or fold strongly between poses; their bending is multiplied by {}",
                        report.foldover_count, options.energy.shell.foldover_damping),
            "smooth the creases there, or set --foldover-damping (1 = off)");
    NewtonSolver solver(*energy, set, options.energy.solver);
    watch.stage_done("poses");

    const Subspace subspace = choose_subspace(solver, options, progress, report);
    report.dimension = subspace.dimension();
    watch.stage_done("subspace");

    const ReducedEnergy reduced(*energy, subspace);
    const std::size_t training_count = set.pose_count() == 2 ? 17 : 32; // fills the predictor's domain; more changed nothing
    const TrainingSet training
        = solve_training_set(reduced, training_weights(set.pose_count(), training_count, options.seed), &progress);
    report.unconverged_training_count = training.unconverged_count;
    watch.stage_done("reduced averages");

    const BuiltStandIn built = build_stand_in(set, reduced, training, options, progress, report);
    report.element_count = built.stand_in->element_count();
    watch.stage_done(options.stand_in == StandInKind::ghost ? "ghost" : "cubature");

    AssetModel model;
    model.set = &set;
    model.subspace = &subspace;
    model.stand_in = built.stand_in.get();
    model.names = poses.names;
    model.polygons = &poses.polygons;
    fit_coordinates(built, training, model, report, progress);
    model.predictor = fit_warm_start(*built.stand_in, training, model, options.seed, progress);
    watch.stage_done("warm start");

    // A first encoding to let the real runtime answer; answers and certificate are written last.
    model.certificate = "{}";
    model.answers.push_back({ training.weights[0], model.mean.cast<float>() });
    collect_answers(model, training, report);
    model.answers.erase(model.answers.begin());
    check_against_unreduced(encode_asset(model), solver, options, progress, report);
    report.factorization_count = solver.factorization_count();
    report.certificate = write_certificate(report, options, poses.names);
    model.certificate = report.certificate;
    out.bytes = encode_asset(model);
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
    const double factorisations = is_adaptive ? 20 + 5 * 1.5 * d : m;
    const double solves = 32 + (is_adaptive ? 2.5 * d : 0);
    estimate.seconds = (factorisations + 6.0 * options.check_count) * factorisation + solves * 20 * gradient + d * d * 1e-2;
    estimate.memory = 18e3 * n + 5 * 24 * n * d; // factor and Hessian, a few copies of the basis
    estimate.asset_size = 12 * n * (d + 1) + 24 * n;
    return estimate;
}

} // namespace pliant
