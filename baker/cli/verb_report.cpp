#include "cli/verbs.h"

#include "base/common/print.h"
#include "input/io/source_file.h"
#include "input/io/write_file.h"
#include "output/page/collect_page_data.h"
#include "output/page/page.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace pliant {

namespace {

struct ReportArguments {
    std::string input, output, up = "y", view = "three-quarter";
    Talk talk;
};

ViewOptions view_of(const ReportArguments& a)
{
    ViewOptions view;
    view.up = a.up == "x" ? UpAxis::x : a.up == "z" ? UpAxis::z : UpAxis::y;
    view.view = a.view == "front" ? View::front : a.view == "side" ? View::side : View::three_quarter;
    return view;
}

std::string read_input(const std::string& path)
{
    DiagnosticList diagnostics;
    const std::optional<std::string> bytes = read_bytes(path, diagnostics);
    if (!bytes) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    return *bytes;
}

ExitCode run_report(const ReportArguments& a)
{
    const std::string bytes = read_input(a.input);
    const bool is_report = looks_like_json(bytes) || std::filesystem::path(a.input).extension() == ".json";
    std::optional<ReportFile> report;
    std::string asset = a.input;
    if (is_report) {
        report = parse_report(bytes, a.input);
        asset = (std::filesystem::path(a.input).parent_path() / report->asset).string();
    }
    try_outputs({ a.output }, { a.input, asset });
    require_suffix("--output", a.output, ".html");
    RuntimeBlender blender = RuntimeBlender::from_file(asset);
    if (report) check_same_bake(bytes, blender.certificate(), a.input, asset);
    ConsoleProgress progress("report", a.talk);
    progress.update("draw", 0);
    const std::string name = std::filesystem::path(asset).filename().string();
    const std::string page = write_page(collect_page_data(blender, name, report ? &*report : nullptr, view_of(a)));
    write_output(a.output, page);
    progress.clear_line();
    if (!a.talk.is_quiet) print_to(stdout, "{}: {:.2f} MiB\n", printable(a.output), double(page.size()) / 1048576.0);
    return ExitCode::done;
}

} // namespace

Verb add_report(CLI::App& app)
{
    auto a = std::make_shared<ReportArguments>();
    CLI::App* verb
        = app.add_subcommand("report", "Write an HTML page about an asset: pictures, errors, sizes, times, warnings");
    verb->footer(
        "Examples:\n  pliant report hero.pliant -o hero.html\n"
        "  pliant bake rest.ply run.ply jump.ply -o hero.pliant --report hero.json && pliant report hero.json -o hero.html\n"
        "The page is one self-contained file for any browser. The asset provides shapes, errors and sizes. The report of "
        "the bake adds\ntimes and warnings; it names the asset by a path relative to its own folder. No display or graphics "
        "driver is needed.");
    verb->add_option("input", a->input, "Asset, or a report that `pliant bake --report` wrote")
        ->required()
        ->type_name("ASSET|REPORT.json");
    verb->add_option("-o,--output", a->output, "Page to write")->required()->type_name("OUT.html");
    verb->add_option("--up", a->up, "Axis that points up in the pictures")
        ->transform(CLI::IsMember({ "x", "y", "z" }, CLI::ignore_case))
        ->capture_default_str()
        ->type_name("AXIS");
    verb->add_option(
            "--view", a->view,
            "Camera: front (the longer horizontal principal axis of the first pose lies across the picture), side (rotated "
            "by 90 degrees) or three-quarter (rotated by 30 degrees, slightly from above)")
        ->transform(CLI::IsMember({ "front", "side", "three-quarter" }, CLI::ignore_case))
        ->capture_default_str()
        ->type_name("NAME");
    add_talk(*verb, a->talk);
    return [a] { return run_report(*a); };
}

} // namespace pliant
