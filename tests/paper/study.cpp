// Errors of subspaces and of whole assets against unreduced averages, for the study (README.md in this folder).
//   pliant_study -o PREFIX [options] POSE...
// Writes PREFIX_subspace.csv, with --asset PREFIX_assets.csv, with --cubatures PREFIX_cubatures.csv, with --snapshots the
// averages themselves as PREFIX_*.npy. With --pipeline PREFIX_pipeline.csv alone.
#include "../baker/tube.h"
#include "cubatures.h"
#include "npy.h"
#include "pipeline.h"
#include "reduced.h"

#include "bake/estimate.h"
#include "bake/make_energy.h"
#include "base/common/parallel.h"
#include "elastic/average/family.h"
#include "input/poses/load_poses.h"
#include "reduced/subspace/barbic.h"
#include "reduced/subspace/krylov.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

using namespace pliant;

namespace {

struct Options {
    std::string prefix;
    std::vector<std::string> poses;
    std::size_t tube_pose_count = 0; // instead of files
    std::vector<Eigen::Index> dimensions = { 3, 5, 9, 17 };
    std::vector<std::string> kinds = { "krylov", "krylov_differences", "barbic", "pod" };
    std::vector<std::string> bases, assets; // NAME=FILE
    std::size_t train_count = 24, fresh_count = 12;
    std::uint64_t seed = 7;
    bool writes_snapshots = false;
    Eigen::Index cubature_dimension = 0; // 0: no cubatures
    CubatureStudy cubature;
    Eigen::Index pipeline_dimension = 0; // 0: the errors; else only the time of the paper's pipeline
    EnergyOptions energy;
};

void tell(const std::string& text)
{
    fmt::print(stderr, "pliant_study: {}\n", text);
    std::fflush(stderr);
}

// Fresh weights. Two poses: a regular grid, which has a quarter, a half and three quarters if count + 1 is a multiple of 4.
// More: uniform, edge, corner-heavy in turn, as `pliant measure` draws them.
std::vector<Reference> fresh_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed)
{
    std::vector<Reference> out;
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        Reference reference;
        if (pose_count == 2) {
            const double t = double(i + 1) / double(count + 1);
            reference.kind = "grid";
            reference.weights = (1 - t) * corner_weights(2, 0) + t * corner_weights(2, 1);
        } else if (i % 3 == 1) {
            const std::size_t a = random.below(pose_count), b = (a + 1 + random.below(pose_count - 1)) % pose_count;
            const double t = 0.1 + 0.8 * random.uniform();
            reference.kind = "edge";
            reference.weights = t * corner_weights(pose_count, a) + (1 - t) * corner_weights(pose_count, b);
        } else {
            reference.kind = i % 3 == 0 ? "uniform" : "corner";
            reference.weights = random_weights(random, pose_count, i % 3 == 2);
        }
        out.push_back(reference);
    }
    return out;
}

// Weights of the snapshots for the POD bound: none of them is fresh.
std::vector<Reference> train_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed)
{
    std::vector<Reference> out;
    for (const Weights& w : training_weights(pose_count, count, seed + 1000003))
        out.push_back({ "train", w, Shape(), false });
    return out;
}

void solve_reference(const AverageFamily& family, std::vector<Reference>& references)
{
    for_each_task(references.size(), [&](std::size_t i, std::size_t worker) {
        NewtonResult result = family.at(references[i].weights, worker, nullptr).average;
        references[i].shape = std::move(result.y);
        references[i].has_converged = result.has_converged;
    });
    int unconverged = 0;
    for (const Reference& reference : references) unconverged += !reference.has_converged;
    if (unconverged) tell(fmt::format("{} of {} unreduced averages did not converge", unconverged, references.size()));
}

struct Named {
    std::string name, path;
};

std::vector<Named> split_names(const std::vector<std::string>& pairs)
{
    std::vector<Named> out;
    for (const std::string& pair : pairs) {
        const std::size_t equals = pair.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Failure(ExitCode::usage, error_at(1203, "", fmt::format("'{}' is not NAME=FILE", pair)));
        out.push_back({ pair.substr(0, equals), pair.substr(equals + 1) });
    }
    return out;
}

class Study {
public:
    Study(const Options& options, const PoseSet& poses)
        : options_(options)
        , set_(normalize(poses))
        , energy_(make_energy(set_, options.energy))
        , solver_(*energy_, set_, default_solver())
    {
        SolverPool pool(*energy_, set_, default_solver());
        AverageFamily family(pool, NewtonOptions(), nullptr);
        mean_energy_ = family.mean().energy;
        mean_hessian_ = family.mean_hessian();
        fresh_ = fresh_weights(set_.pose_count(), options.fresh_count, options.seed);
        train_ = train_weights(set_.pose_count(), options.train_count, options.seed);
        tell(fmt::format("{} unreduced averages", fresh_.size() + train_.size()));
        solve_reference(family, fresh_);
        solve_reference(family, train_);
    }

    void run()
    {
        if (options_.writes_snapshots) write_snapshots();
        subspaces();
        if (!options_.assets.empty()) assets();
        if (options_.cubature_dimension > 0) cubatures();
    }

private:
    // One row per basis, dimension and fresh weight.
    void subspaces()
    {
        csv_ = "basis,d,kind,weights,solved_l2,solved_distance,projected_l2,truth_converged\n";
        linear();
        for (const Named& basis : split_names(options_.bases)) {
            const Subspace full = subspace_of(RuntimeBlender::from_file(basis.path), set_, basis.path);
            for (Eigen::Index d : options_.dimensions)
                if (d <= full.dimension()) measure(basis.name, leading_part(full, d));
        }
        for (const std::string& kind : options_.kinds)
            for (Eigen::Index d : options_.dimensions)
                if (kind != "none" && d >= Eigen::Index(set_.pose_count()) - 1) measure(kind, build(kind, d));
        write_file_atomically(options_.prefix + "_subspace.csv", csv_);
    }

    Subspace build(const std::string& kind, Eigen::Index d)
    {
        if (kind == "krylov") return build_krylov_subspace(solver_, { 0, d, 256 }, nullptr);
        if (kind == "krylov_differences")
            return build_krylov_subspace(solver_, { 0, d, 256, KrylovStart::differences }, nullptr);
        if (kind == "barbic") return build_barbic_subspace(solver_, { 0, d, 256 }, nullptr);
        Eigen::MatrixXd snapshots(set_.dof_count(), Eigen::Index(train_.size()));
        for (std::size_t i = 0; i < train_.size(); ++i) snapshots.col(Eigen::Index(i)) = train_[i].shape - set_.shapes[0];
        return build_subspace(set_, snapshots, d);
    }

    void add_row(const std::string& basis, Eigen::Index d, const Reference& reference, const Shape& blend, double projected)
    {
        const ShapeError error = shape_error(*energy_, set_, reference.weights, blend, reference.shape);
        csv_ += fmt::format("{},{},{},{},{:.6e},{:.6e},{:.6e},{}\n", basis, d, reference.kind,
                            weights_cell(reference.weights), error.relative_l2, error.largest_distance, projected,
                            int(reference.has_converged));
    }

    void linear()
    {
        const Subspace differences = build_subspace(set_, Eigen::MatrixXd(set_.dof_count(), 0), 0);
        for (const Reference& reference : fresh_)
            add_row("linear", differences.dimension(), reference, linear_blend(set_, reference.weights),
                    projection_error(set_, differences, reference.shape));
    }

    void measure(const std::string& basis, const Subspace& subspace)
    {
        const auto start = std::chrono::steady_clock::now();
        const Eigen::MatrixXd q = solve_reduced(*energy_, set_, subspace, fresh_);
        for (std::size_t i = 0; i < fresh_.size(); ++i)
            add_row(basis, subspace.dimension(), fresh_[i], subspace.shape(q.col(Eigen::Index(i))),
                    projection_error(set_, subspace, fresh_[i].shape));
        tell(fmt::format("{}, d = {}: {:.1f} s", basis, subspace.dimension(),
                         std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
    }

    // Total error of the runtime's blends, and its two parts: the subspace's (exact reduced average against the reference
    // average) and the surrogate energy's (blend against the exact reduced average).
    void assets()
    {
        std::string csv
            = "asset,d,elements,kind,weights,total_l2,total_distance,subspace_l2,stand_in_l2,iterations,truth_converged\n";
        for (const Named& named : split_names(options_.assets)) {
            RuntimeBlender blender = RuntimeBlender::from_file(named.path);
            const Subspace subspace = subspace_of(blender, set_, named.path);
            const auto certificate = nlohmann::json::parse(blender.certificate());
            const int element_count = certificate.value(nlohmann::json::json_pointer("/stand_in/elements"), 0);
            const Eigen::MatrixXd q = solve_reduced(*energy_, set_, subspace, fresh_);
            for (std::size_t i = 0; i < fresh_.size(); ++i) {
                const Reference& reference = fresh_[i];
                const Eigen::VectorXf w = reference.weights.cast<float>();
                pliant_solve_info info {};
                const Shape blend = from_input_units(
                    set_, blender.positions(blender.solve(std::vector<float>(w.data(), w.data() + w.size()), false, &info)));
                const Shape reduced = subspace.shape(q.col(Eigen::Index(i)));
                const ShapeError error = shape_error(*energy_, set_, reference.weights, blend, reference.shape);
                csv += fmt::format("{},{},{},{},{},{:.6e},{:.6e},{:.6e},{:.6e},{},{}\n", named.name, subspace.dimension(),
                                   element_count, reference.kind, weights_cell(reference.weights), error.relative_l2,
                                   error.largest_distance, relative_distance(set_, reduced, reference.shape),
                                   relative_distance(set_, blend, reduced), info.iterations, int(reference.has_converged));
            }
            tell(fmt::format("asset {}: d = {}, {} elements", named.name, subspace.dimension(), element_count));
        }
        write_file_atomically(options_.prefix + "_assets.csv", csv);
    }

    // In the subspace of Algorithm 1, as the paper has it.
    void cubatures()
    {
        const Subspace subspace = build("krylov", options_.cubature_dimension);
        const ReducedSolver reduced(*energy_, subspace, mean_hessian_, mean_energy_);
        const std::size_t m = set_.pose_count();
        const TrainingSet training
            = solve_training_set(reduced, set_, training_weights(m, training_count(m), options_.seed + 1), nullptr);
        const Eigen::MatrixXd exact = solve_reduced(*energy_, set_, subspace, fresh_);
        tell(fmt::format("cubatures, d = {}", subspace.dimension()));
        write_file_atomically(options_.prefix + "_cubatures.csv",
                              cubature_rows(reduced, set_, training, fresh_, exact, options_.cubature));
    }

    // In normalized units: relative to pose 0's centroid, mean area 1, total mass 1.
    void write_snapshots() const
    {
        using Floats = Eigen::Matrix<float, -1, -1, Eigen::RowMajor>;
        using Doubles = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
        const auto write = [&](const char* name, const std::vector<Reference>& references) {
            Floats shapes(Eigen::Index(references.size()), set_.dof_count());
            Doubles weights(Eigen::Index(references.size()), Eigen::Index(set_.pose_count()));
            for (std::size_t i = 0; i < references.size(); ++i) {
                shapes.row(Eigen::Index(i)) = references[i].shape.transpose().cast<float>();
                weights.row(Eigen::Index(i)) = references[i].weights.transpose();
            }
            write_npy<float>(fmt::format("{}_{}.npy", options_.prefix, name), "<f4", shapes);
            write_npy<double>(fmt::format("{}_{}_weights.npy", options_.prefix, name), "<f8", weights);
        };
        write("fresh", fresh_);
        write("train", train_);
        std::vector<Reference> poses;
        for (std::size_t k = 0; k < set_.pose_count(); ++k)
            poses.push_back({ "pose", corner_weights(set_.pose_count(), k), set_.shapes[k], true });
        write("poses", poses);
        write_npy<double>(options_.prefix + "_masses.npy", "<f8", set_.masses);
        Eigen::Matrix<std::int32_t, -1, -1, Eigen::RowMajor> faces(Eigen::Index(set_.triangles.size()), 3);
        for (std::size_t f = 0; f < set_.triangles.size(); ++f)
            for (int c = 0; c < 3; ++c) faces(Eigen::Index(f), c) = std::int32_t(set_.triangles[f][std::size_t(c)]);
        write_npy<std::int32_t>(options_.prefix + "_faces.npy", "<i4", faces);
    }

    const Options& options_;
    NormalizedPoses set_;
    std::unique_ptr<Energy> energy_;
    NewtonSolver solver_;
    double mean_energy_ = 0;
    SparseLower mean_hessian_;
    std::vector<Reference> fresh_, train_;
    std::string csv_;
};

} // namespace

int main(int argc, char** argv)
try {
    Options options;
    options.energy.continuity = Continuity::off; // thin shells, as in the paper
    CLI::App app("Errors of subspaces and assets against unreduced averages; tests/paper says what for");
    app.add_option("-o,--output", options.prefix, "Prefix of what is written")->required();
    app.add_option("poses", options.poses, "Pose files");
    app.add_option("--tube", options.tube_pose_count, "Built-in poses of a tube instead of files")->check(CLI::Range(2, 4));
    app.add_option("--dims", options.dimensions, "Dimensions")->delimiter(',');
    app.add_option("--kinds", options.kinds, "Of krylov, krylov_differences, barbic, pod; or none")
        ->delimiter(',')
        ->check(CLI::IsMember({ "krylov", "krylov_differences", "barbic", "pod", "none" }));
    app.add_option("--basis", options.bases, "NAME=ASSET: measure the leading dimensions of this asset's subspace")
        ->allow_extra_args(false);
    app.add_option("--asset", options.assets, "NAME=ASSET: measure the runtime's blends of this asset")
        ->allow_extra_args(false);
    app.add_option("--train", options.train_count, "Snapshots for the POD bound")->check(CLI::Range(1, 10000));
    app.add_option("--fresh", options.fresh_count, "Weights at which errors are measured")->check(CLI::Range(1, 10000));
    app.add_option("--seed", options.seed, "Seed of the weights");
    app.add_option("--cubatures", options.cubature_dimension,
                   "Compare the paper's cubature with ours in Algorithm 1's subspace of so many dimensions");
    app.add_option("--cubature-poses", options.cubature.pose_count, "Training poses of each example pose for it")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    app.add_option("--pipeline", options.pipeline_dimension,
                   "Only the time of the paper's pipeline in so many dimensions, as PREFIX_pipeline.csv");
    const std::map<std::string, Material> materials = { { "discrete-shells", Material::discrete_shells },
                                                        { "arap", Material::arap },
                                                        { "stvk", Material::stvk },
                                                        { "mooney-rivlin", Material::mooney_rivlin } };
    app.add_option("--material", options.energy.material, "Default: discrete-shells for surfaces, stvk for solids")
        ->transform(CLI::CheckedTransformer(materials));
    app.add_flag("--snapshots", options.writes_snapshots, "Also write the averages, for numpy");
    app.add_option_function<unsigned>("--threads", set_thread_count, "Threads for element loops")
        ->check(CLI::Range(1u, 256u));
    CLI11_PARSE(app, argc, argv);
    if (options.poses.empty() == (options.tube_pose_count == 0)) {
        tell("give pose files or --tube");
        return int(ExitCode::usage);
    }
    const PoseSet poses = options.tube_pose_count ? tube_poses(options.tube_pose_count) : load_poses(options.poses);
    if (options.pipeline_dimension > 0)
        write_file_atomically(options.prefix + "_pipeline.csv",
                              pipeline_csv(poses, options.energy, options.pipeline_dimension));
    else
        Study(options, poses).run();
    return 0;
} catch (const Failure& failure) {
    tell(failure.what());
    return int(failure.code());
}
