// Table II of von Tycowicz et al. 2015: a bar of St. Venant-Kirchhoff material, straight and twisted by 90 and 180 degrees,
// blended in subspaces of several sorts and sizes.
//   pliant_bar [-o OUT.csv] [options]
// Writes the error at each weight, beside the mean that the paper prints (in 1e-4, 0: none), as CSV to OUT.csv or to
// standard output; tables.py makes the table. The paper gives neither Poisson's ratio nor the bar's proportions: those are
// the options' defaults.
//   pliant_bar --write FOLDER [--degrees 90,180]
// writes the bars as pose files instead, for `pliant bake`.
#include "../baker/twisted_bar.h"

#include "base/common/parallel.h"
#include "base/mesh/align.h"
#include "elastic/average/family.h"
#include "elastic/average/shape_error.h"
#include "elastic/energy/solid.h"
#include "input/io/encode_msh.h"
#include "input/io/write_file.h"
#include "reduced/subspace/adaptive.h"
#include "reduced/subspace/barbic.h"
#include "reduced/subspace/krylov.h"
#include "reduced/surrogate/surrogate_energy.h"
#include "reduced/surrogate/training.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fmt/core.h>

using namespace pliant;

namespace {

struct Options {
    int cells = 8, length_cells = 48, sample_count = 101;
    double poisson = 0.4;
    std::vector<double> degrees = { 90, 180 };
    std::string output, folder;
};

double radians(double degrees) { return degrees * 3.14159265358979323846 / 180; }

// What the paper prints, in 1e-4; 0: nothing.
struct Row {
    const char* kind;
    Eigen::Index d;
    double paper_90, paper_180;
};
const Row rows[] = { { "Algorithm 1", 3, 0.70, 5.84 },
                     { "Algorithm 1", 9, 0.14, 1.44 },
                     { "Algorithm 1", 17, 0.14, 0.59 },
                     { "Krylov of differences", 9, 0, 0 },
                     { "Krylov of differences", 17, 0, 0 },
                     { "Barbic et al.", 3, 5.70, 26.75 },
                     { "Barbic et al.", 9, 3.20, 7.30 },
                     { "Barbic et al.", 17, 1.38, 6.80 },
                     { "adaptive", 3, 0, 0 },
                     { "adaptive", 5, 0, 0 },
                     { "adaptive", 9, 0, 0 } };

void tell(const std::string& text)
{
    fmt::print(stderr, "pliant_bar: {}\n", text);
    std::fflush(stderr);
}

// Newton down to rounding: errors of 1e-8 are to be seen.
NewtonOptions exact_newton()
{
    NewtonOptions options;
    options.decrement = 1e-15;
    options.residual = 1e-7;
    return options;
}

class Bar {
public:
    Bar(const Options& options, double degrees)
        : set_(normalize(twisted_bar(options.cells, options.length_cells, radians(degrees))))
        , solid_(set_, { SolidLaw::stvk, options.poisson })
        , pool_(solid_, set_, default_solver())
        , family_(pool_, exact_newton(), nullptr)
    {
        tell(fmt::format("{} degrees: {} vertices, {} tetrahedra, {} unreduced averages", degrees, set_.dof_count() / 3,
                         set_.tets.size(), options.sample_count));
        family_.mean();
        follow(options.sample_count);
    }

    // The relative L2 error at each weight.
    std::vector<double> measure(const std::string& kind, Eigen::Index d)
    {
        const Subspace subspace = subspace_of(kind, d);
        const auto start = std::chrono::steady_clock::now();
        Quartic quartic(solid_, subspace, nullptr);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        tell(fmt::format("{}, d = {}: quartic of {} tetrahedra and 2 poses in {:.2f} s on {} threads", kind, d,
                         set_.tets.size(), seconds.count(), worker_count()));
        const SurrogateEnergy exact(solid_, std::move(quartic));
        std::vector<double> errors(truths_.size());
        for_each_task(truths_.size(), [&](std::size_t i, std::size_t) {
            const MinimizeResult found
                = minimize_newton(exact, weights_[i], project(subspace, truths_[i], set_.masses), 1e-12, 60);
            errors[i] = relative_distance(set_, subspace.shape(found.q), truths_[i]);
        });
        return errors;
    }

    double second_weight(std::size_t i) const { return weights_[i][1]; }

private:
    // The averages along the edge from pose 0 to pose 1, each from its neighbours.
    void follow(int count)
    {
        NewtonSolver& solver = pool_.at(0);
        for (int i = 0; i < count; ++i) {
            const double t = double(i) / (count - 1);
            weights_.push_back(Eigen::Vector2d(1 - t, t));
            const std::size_t n = truths_.size();
            if (i == 0 || i == count - 1) { // a pose is its own average
                truths_.push_back(set_.shapes[i == 0 ? 0 : 1]);
                continue;
            }
            const Shape start = n == 1 ? truths_[0] : Shape(2 * truths_[n - 1] - truths_[n - 2]);
            NewtonResult result = solver.minimize(weights_.back(), start, exact_newton());
            if (!result.has_converged) tell(fmt::format("the average for weight {} did not converge", t));
            align_to(set_, set_.shapes[0], result.y);
            truths_.push_back(std::move(result.y));
        }
    }

    Subspace subspace_of(const std::string& kind, Eigen::Index d)
    {
        if (kind == "Algorithm 1") return build_krylov_subspace(pool_.at(0), { 2, d, 256 }, nullptr);
        if (kind == "Krylov of differences")
            return build_krylov_subspace(pool_.at(0), { 2, d, 256, KrylovStart::differences }, nullptr);
        if (kind == "Barbic et al.") return build_barbic_subspace(pool_.at(0), { 4, d, 256 }, nullptr);
        if (!adaptive_) {
            family_.mean();
            InterpolatedFamily known(family_, nullptr);
            AdaptiveOptions options;
            options.tolerance = 0; // nothing is interpolated
            adaptive_ = build_adaptive_subspace(known, training_weights(2, 33, 1), {}, options, nullptr).subspace;
        }
        return leading(*adaptive_, std::min(d, adaptive_->dimension()));
    }

    NormalizedPoses set_;
    Solid solid_;
    SolverPool pool_;
    AverageFamily family_;
    std::vector<Weights> weights_;
    std::vector<Shape> truths_;
    std::optional<Subspace> adaptive_;
};

void run(const Options& options)
{
    std::vector<std::unique_ptr<Bar>> bars;
    for (double degrees : options.degrees) bars.push_back(std::make_unique<Bar>(options, degrees));
    std::string csv = "degrees,basis,d,weight,relative_l2,paper_mean_1e4\n";
    for (const Row& row : rows)
        for (std::size_t b = 0; b < bars.size(); ++b) {
            const std::vector<double> errors = bars[b]->measure(row.kind, row.d);
            const double degrees = options.degrees[b];
            const double paper = degrees == 90 ? row.paper_90 : degrees == 180 ? row.paper_180 : 0;
            for (std::size_t i = 0; i < errors.size(); ++i)
                csv += fmt::format("{:g},{},{},{:.6g},{:.6e},{:g}\n", degrees, row.kind, row.d, bars[b]->second_weight(i),
                                   errors[i], paper);
        }
    options.output.empty() ? fmt::print("{}", csv) : write_file_atomically(options.output, csv);
}

void write_poses(const Options& options)
{
    for (double degrees : options.degrees) {
        const PoseSet bar = twisted_bar(options.cells, options.length_cells, radians(degrees));
        write_file_atomically(options.folder + "/bar_straight.msh", encode_msh(bar.positions[0], bar.tets));
        write_file_atomically(fmt::format("{}/bar_{:g}.msh", options.folder, degrees),
                              encode_msh(bar.positions[1], bar.tets));
    }
}

} // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App app("Table II: errors of reduced blends of a twisted bar");
    app.add_option("-o,--output", options.output, "Where the errors go; default: standard output")->type_name("OUT.csv");
    app.add_option("--write", options.folder, "Write the bars as pose files, and no table")->type_name("FOLDER");
    app.add_option("--cells", options.cells, "Cubes across")->check(CLI::Range(1, 64))->capture_default_str();
    app.add_option("--length-cells", options.length_cells, "Cubes along")->check(CLI::Range(2, 384))->capture_default_str();
    app.add_option("--samples", options.sample_count, "Weights, evenly spaced, both poses among them")
        ->check(CLI::Range(3, 10001))
        ->capture_default_str();
    app.add_option("--poisson", options.poisson, "Poisson's ratio")->check(CLI::Range(0.0, 0.499))->capture_default_str();
    app.add_option("--degrees", options.degrees, "Angles of twist")->delimiter(',')->capture_default_str();
    app.add_option_function<unsigned>("--threads", set_thread_count, "Threads");
    CLI11_PARSE(app, argc, argv);
    try {
        options.folder.empty() ? run(options) : write_poses(options);
    } catch (const std::exception& error) {
        fmt::print(stderr, "pliant_bar: {}\n", error.what());
        return 1;
    }
    return 0;
}
