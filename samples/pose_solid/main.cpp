// pose_solid: poses a solid of tetrahedra by dragging groups of its vertices, and writes the deformed mesh.
#include "base/common/parallel.h"
#include "elastic/pose/drag.h"
#include "elastic/pose/rest_pose.h"
#include "input/io/encode_msh.h"
#include "input/io/write_file.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fmt/core.h>
#include <new>

namespace {

using namespace pliant;

constexpr char description[]
    = "Poses a solid: drags groups of its vertices to targets, lets elastic energy find the rest, and "
      "writes the deformed mesh, a pose for `pliant bake`.";

constexpr char footer[] = R"(The script has one handle a line, a region and what happens to its vertices:
  box x0 y0 z0 x1 y1 z1  |  sphere x y z r  |  vertices i j k ...
  hold  |  move dx dy dz  |  turn px py pz ax ay az degrees
Points are fractions of the bounding box of REST, lengths (r, dx dy dz) of its diagonal, vertices count from 0 as in the file.
A turn is about the axis ax ay az through the point px py pz, counter-clockwise where the axis points at you. Several motions
behind each other are made one after the other. A vertex in several regions belongs to the first line; # starts a comment.

Example, a bar along x, one end held, the other bent by 90 degrees and twisted by 60:
  box 0 0 0 0.1 1 1     hold
  box 0.9 0 0 1 1 1     turn 0.9 0.5 0.5  1 0 0  60  turn 0.5 0.5 0.5  0 0 1  90
  pose_solid bar.msh -o bent.msh --script bent.txt && pliant bake bar.msh bent.msh -o bar.pliant

Exit codes: 0 done, 1 failed while working, 2 wrong usage, 3 bad input file.)";

struct Options {
    std::string rest, output, script, ply;
    SolidOptions material { SolidLaw::mooney_rivlin, -1 };
    bool is_quiet = false;
};

// The baker's findings have a number, this program's own have none.
void print_finding(const Finding& finding)
{
    std::string text;
    if (finding.number != 0) {
        text = to_text(finding);
    } else {
        text = "error: " + (finding.where.empty() ? "" : finding.where + ": ") + finding.what;
        if (!finding.hint.empty()) text += "\n  hint: " + finding.hint;
    }
    fmt::print(stderr, "pose_solid: {}\n", text);
}

void add_options(CLI::App& app, Options& options)
{
    app.footer(footer);
    app.add_option("rest", options.rest, "Rest pose: .msh (Gmsh) .mesh (MEDIT) .veg (Vega) .vtk")
        ->required()
        ->type_name("REST");
    app.add_option("-o,--output", options.output, "Deformed mesh to write, Gmsh 2.2; vertices and tetrahedra as in REST")
        ->required()
        ->type_name("OUT.msh");
    app.add_option("-s,--script", options.script, "Regions and their motions, see below")->required()->type_name("FILE");
    app.add_option("--ply", options.ply, "Write the boundary of the deformed mesh too, for looking at it")
        ->type_name("OUT.ply");
    app.add_option_function<std::string>(
           "--material",
           [&options](const std::string& name) {
               options.material.law = name == "stvk" ? SolidLaw::stvk : SolidLaw::mooney_rivlin;
           },
           "Elastic energy: mooney-rivlin (holds its volume) or stvk (St. Venant-Kirchhoff)")
        ->check(CLI::IsMember(std::vector<std::string> { "mooney-rivlin", "stvk" }))
        ->default_str("mooney-rivlin")
        ->type_name("NAME");
    app.add_option(
           "--poisson", options.material.poisson,
           "Poisson's ratio (default: 0.45 for mooney-rivlin, 0.4 for stvk); where a .veg file gives moduli, those count")
        ->check(CLI::Range(0.0, 0.499));
    app.add_option_function<unsigned>("--threads", set_thread_count, "Threads for element loops (default: all cores)")
        ->check(CLI::Range(1u, 256u));
    app.add_flag("-q,--quiet", options.is_quiet, "No progress, only warnings and errors");
}

// Before long work: what would make writing fail.
void check_outputs(const Options& options)
{
    if (std::filesystem::path(options.output).extension() != ".msh")
        throw Failure(ExitCode::usage,
                      complaint("", fmt::format("--output: '{}' does not end in .msh", options.output),
                                "the deformed mesh is written in Gmsh's format"));
    probe_output(options.output, { options.rest, options.script });
    if (options.ply.empty()) return;
    if (std::filesystem::path(options.ply).extension() != ".ply")
        throw Failure(ExitCode::usage,
                      complaint("", fmt::format("--ply: '{}' does not end in .ply", options.ply),
                                "the boundary is written in the PLY format"));
    probe_output(options.ply, { options.rest, options.script });
}

void stop_at_errors(const FindingList& findings)
{
    if (findings.has_errors()) throw Failure(ExitCode::bad_input, findings.findings());
}

void print_step(const Handles& handles, const DragStep& step)
{
    fmt::print(
        stderr, "pose_solid: {:5.1f} % of the motion{}: energy {:.4e} (from {:.4e}), smallest J {:.3f}, {} iterations{}\n",
        100 * step.time, handles.nominal_steps() > 1 ? fmt::format(" ({} steps planned)", handles.nominal_steps()) : "",
        step.energy, step.start_energy, step.smallest_j, step.iterations,
        step.halvings > 0 ? fmt::format(", halved {} times", step.halvings) : "");
}

ExitCode run(const Options& options)
{
    check_outputs(options);
    FindingList findings;
    const Script script = read_script(options.script, findings);
    const std::optional<RestPose> rest = read_rest_pose(options.rest, findings);
    stop_at_errors(findings);
    const Handles handles(script, rest->mesh.positions, findings);
    stop_at_errors(findings);
    for (const Finding& warning : findings.findings()) print_finding(warning);
    if (!options.is_quiet)
        for (std::size_t i = 0; i < handles.size(); ++i)
            fmt::print(stderr, "pose_solid: {}: {} vertices\n", script.where(script.lines[i]), handles.count(i));

    const ShapeSet set = to_shape_set(*rest, handles.vertices());
    const DragResult result = drag(set, handles, options.material, [&](const DragStep& step) {
        if (!options.is_quiet) print_step(handles, step);
    });
    const std::string msh = encode_msh(result.positions, rest->as_read);
    write_file_atomically(options.output, msh);
    if (!options.ply.empty()) write_file_atomically(options.ply, encode_boundary(*rest, result.positions));
    fmt::print("{}: energy {:.4e}, smallest J {:.3f}, {} steps, {} iterations\n", options.output, result.last.energy,
               result.last.smallest_j, result.steps, result.iterations);
    return ExitCode::done;
}

ExitCode guarded(const Options& options)
{
    try {
        return run(options);
    } catch (const Failure& failure) {
        for (const Finding& finding : failure.findings()) print_finding(finding);
        return failure.code();
    } catch (const std::bad_alloc&) {
        print_finding(complaint("", "memory ran out", "a coarser mesh needs less"));
    } catch (const std::exception& error) {
        print_finding(complaint("", error.what(), ""));
    }
    return ExitCode::failed;
}

} // namespace

int main(int argc, char** argv)
{
    CLI::App app(description, "pose_solid");
    Options options;
    add_options(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error); // --help
        print_finding(complaint("", error.what(), "`pose_solid --help` shows how"));
        return int(ExitCode::usage);
    }
    const ExitCode code = guarded(options);
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
        print_finding(complaint("", "standard output could not be written", ""));
        return int(ExitCode::failed);
    }
    return int(code);
}
