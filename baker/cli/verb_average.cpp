#include "cli/verbs.h"

#include "average/family.h"
#include "io/encode_ply.h"
#include "io/write_file.h"

#include <fmt/core.h>
#include <memory>

namespace pliant {

namespace {

struct Arguments {
    std::vector<std::string> poses;
    std::string weights, output;
    EnergyOptions energy;
    NewtonOptions newton;
    bool all_vertices = false, is_quiet = false;
};

ExitCode run(const Arguments& a)
{
    const std::vector<double> values = parse_weights(a.weights);
    const Weights w = normalised_weights(values, a.poses.size());
    probe_output(a.output, input_files(a.poses, a.energy));
    ConsoleProgress progress("average", a.is_quiet);
    const PoseSet poses = load_with_warnings("average", a.poses, a.energy);
    const ShapeSet set = normalise(poses, a.energy.keep_placement);
    const std::unique_ptr<Energy> energy = make_energy(set, a.energy);
    SolverPool pool(*energy, set, a.energy.solver);
    AverageFamily family(pool, a.newton, &progress);
    family.mean();
    const FamilyPoint point = family.at(w, 0, &progress);
    const NewtonResult& result = point.average;
    if (!result.has_converged)
        throw Failure(
            ExitCode::failed,
            error_at(4303, "",
                     fmt::format("the average did not converge: relative decrement {:.1e} (wanted {:.1e}), unbalanced "
                                 "force {:.1e} (wanted {:.1e}) after {} iterations",
                                 result.decrement, a.newton.decrement, result.residual, a.newton.residual,
                                 result.iterations),
                     "add an in-between pose, or try another --thickness or a smaller --foldover-damping"));
    write_output(a.output, encode_ply(to_input_units(set, result.y), poses, a.all_vertices));
    progress.clear_line();
    for (const BranchFinding& jump : point.jumps)
        progress.warn(4406,
                      fmt::format("the average jumps on the way towards pose {}: {:.1f} %, most at vertex {}, weights {}",
                                  poses.names[jump.pose], 100 * jump.distance, poses.file_number(jump.vertex),
                                  weights_text(jump.weights)),
                      "add a pose in between, so that there is only one way to bend");
    if (!a.is_quiet)
        fmt::print("{}: energy {:.6e}, decrement {:.1e}, {} factorisations\n", a.output, result.energy, result.decrement,
                   pool.factorization_count());
    return ExitCode::done;
}

} // namespace

Verb add_average(CLI::App& app)
{
    auto a = std::make_shared<Arguments>();
    CLI::App* verb = app.add_subcommand("average", "Compute the unreduced elastic average: the truth, slowly");
    verb->footer("Example:\n  pliant average rest.ply run.ply --weights 1,1 -o between.ply");
    add_pose_arguments(*verb, a->poses);
    verb->add_option("-w,--weights", a->weights, "One weight per pose, separated by commas")
        ->required()
        ->type_name("W1,W2,...");
    verb->add_option("-o,--output", a->output, "Mesh to write")->required()->type_name("OUT.ply");
    add_energy_options(*verb, a->energy);
    add_all_vertices(*verb, a->all_vertices);
    add_threads(*verb);
    add_quiet(*verb, a->is_quiet);
    return [a] { return run(*a); };
}

} // namespace pliant
