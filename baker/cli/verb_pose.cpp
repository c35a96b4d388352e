#include "cli/verbs.h"

#include "base/common/print.h"
#include "elastic/pose/drag.h"
#include "elastic/pose/rest_pose.h"
#include "input/io/encode_msh.h"

#include <fmt/core.h>
#include <memory>

namespace pliant {

namespace {

struct PoseArguments {
    std::string rest, script, output, ply;
    SolidOptions material { SolidLaw::mooney_rivlin, -1 };
    Talk talk;
};

constexpr char footer[] = R"(The script has one handle per line: a region, and the motion of its vertices.
  box x0 y0 z0 x1 y1 z1  |  sphere x y z r  |  vertices i j k ...
  hold  |  move dx dy dz  |  turn px py pz ax ay az degrees
Points are fractions of the bounding box of REST; lengths (r, dx dy dz) are fractions of its diagonal. Vertices are
counted from 0 in the order of the file. A turn is about the axis ax ay az through the point px py pz, counter-clockwise
if the axis points towards you. Several motions on a line are applied in order. A vertex in several regions belongs to
the first line that names it; # starts a comment.

Example: bent.txt holds one end of a bar along x, twists the other by 60 degrees and bends it by 90:
  box 0 0 0  0.1 1 1     hold
  box 0.9 0 0  1 1 1     turn 0.9 0.5 0.5  1 0 0  60  turn 0.5 0.5 0.5  0 0 1  90
  pliant pose bar.msh bent.txt -o bent.msh && pliant bake bar.msh bent.msh -o bar.pliant)";

void stop_at_errors(const DiagnosticList& diagnostics)
{
    if (diagnostics.has_errors()) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
}

void print_regions(const Script& script, const Handles& handles)
{
    for (std::size_t i = 0; i < handles.size(); ++i)
        print_to(stderr, "pliant pose: {}: {} vertices\n", script.where(script.lines[i]), handles.count(i));
}

DragResult drag_with_progress(const PoseArguments& a, const RestPose& rest, const Handles& handles)
{
    ConsoleProgress progress("pose", a.talk);
    progress.update("motion", 0);
    return drag(to_shape_set(rest, handles.vertices()), handles, a.material, [&](const DragStep& step) {
        if (step.snap > 0)
            progress.warn(4307,
                          fmt::format("the body snaps over at {:.1f} % of the motion: a vertex moves by {:.3g}, the energy "
                                      "falls from {:.3g} to {:.3g}",
                                      100 * step.time, step.snap, step.last_energy, step.energy),
                          "turn or move by less: a body that is twisted too far loses whole turns");
        progress.update("motion", step.time, fmt::format("energy {:.4e}, smallest J {:.3f}", step.energy, step.smallest_j));
    });
}

ExitCode run_pose(const PoseArguments& a)
{
    require_suffix("--output", a.output, ".msh");
    require_suffix("--ply", a.ply, ".ply");
    try_outputs({ a.output, a.ply }, { a.rest, a.script });
    DiagnosticList diagnostics;
    const std::optional<RestPose> rest = read_rest_pose(a.rest, diagnostics);
    const Script script = read_script(a.script, diagnostics);
    stop_at_errors(diagnostics);
    const Handles handles(script, rest->mesh.positions, diagnostics);
    stop_at_errors(diagnostics);
    for (const Diagnostic& warning : diagnostics.diagnostics()) print_finding("pose", warning);
    if (!a.talk.is_quiet) print_regions(script, handles);

    const DragResult result = drag_with_progress(a, *rest, handles);
    write_output(a.output, encode_msh(result.positions, rest->as_read));
    if (!a.ply.empty()) write_output(a.ply, encode_boundary(*rest, result.positions));
    if (!a.talk.is_quiet)
        print_to(stdout, "{}: energy {:.4e}, smallest J {:.3f}, {} steps, {} iterations\n", printable(a.output),
                 result.last.energy, result.last.smallest_j, result.steps, result.iterations);
    return ExitCode::done;
}

void add_material(CLI::App& verb, SolidOptions& material)
{
    verb.add_option_function<std::string>(
            "--material",
            [&material](const std::string& name) {
                material.law = name == "stvk" ? SolidLaw::stvk : SolidLaw::mooney_rivlin;
            },
            "Elastic energy: mooney-rivlin (preserves volume) or stvk (St. Venant-Kirchhoff)")
        ->transform(CLI::IsMember(std::vector<std::string> { "mooney-rivlin", "stvk" }, CLI::ignore_case))
        ->default_str("mooney-rivlin")
        ->type_name("NAME");
    verb.add_option("--poisson", material.poisson,
                    "Poisson's ratio (default: 0.45 for mooney-rivlin, 0.4 for stvk); the materials of a .veg file "
                    "take precedence")
        ->check(number_in(0.0, 0.499));
}

} // namespace

Verb add_pose(CLI::App& app)
{
    auto a = std::make_shared<PoseArguments>();
    CLI::App* verb
        = app.add_subcommand("pose", "Make a new pose of a solid: you move some vertices, the others follow elastically");
    verb->footer(footer);
    verb->add_option("rest", a->rest, "Rest pose, a solid of tetrahedra: .msh (Gmsh) .mesh (MEDIT) .veg (Vega) .vtk")
        ->required()
        ->type_name("REST");
    verb->add_option("script", a->script, "Text file of regions and their motions, see below")
        ->required()
        ->type_name("SCRIPT");
    verb->add_option("-o,--output", a->output, "Deformed mesh to write, Gmsh 2.2; vertices and tetrahedra as in REST")
        ->required()
        ->type_name("OUT.msh");
    verb->add_option("--ply", a->ply, "Also write the boundary of the deformed mesh, for viewing")->type_name("OUT.ply");
    add_material(*verb, a->material);
    add_threads(*verb);
    add_talk(*verb, a->talk);
    return [a] { return run_pose(*a); };
}

} // namespace pliant
