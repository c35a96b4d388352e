#include "cli/verbs.h"

#include "base/common/memory.h"
#include "base/common/print.h"
#include "cli/manifest.h"
#include "input/io/source_file.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fmt/core.h>
#include <memory>
#include <thread>

namespace pliant {

namespace {

struct BatchArguments {
    std::string manifest, report, memory;
    std::vector<std::string> only;
    std::size_t job_count = 1;
    bool is_json = false, is_dry_run = false, is_forced = false, is_fail_fast = false, is_keep_going = false;
    Talk talk;
};

// A fifth is for the system and for what estimates miss.
constexpr double memory_share = 0.8;

unsigned threads_for_each(std::size_t job_count)
{
    return unsigned(std::clamp<std::size_t>(std::thread::hardware_concurrency() / job_count, 1, 256));
}

void keep_only(std::vector<BatchJob>& jobs, const std::vector<std::string>& only)
{
    if (only.empty()) return;
    std::vector<std::string> names;
    for (const BatchJob& job : jobs) names.push_back(job.name);
    for (const std::string& name : only) {
        if (std::find(names.begin(), names.end(), name) != names.end()) continue;
        const std::string nearest = nearest_word(name, names);
        throw Failure(ExitCode::usage,
                      error_at(1304, "", fmt::format("--only {}: the manifest has no such bake", excerpt(name)),
                               nearest.empty() ? "a bake has its \"name\", or the name of its output without .pliant"
                                               : fmt::format("did you mean {}?", nearest)));
    }
    const auto is_left_out
        = [&](const BatchJob& job) { return std::find(only.begin(), only.end(), job.name) == only.end(); };
    jobs.erase(std::remove_if(jobs.begin(), jobs.end(), is_left_out), jobs.end());
}

// Of --memory. A number without a unit is one of bytes, but who writes 16 means another.
double bytes_of(const std::string& text)
{
    constexpr const char* digits = "0123456789";
    const std::size_t unit = text.find_first_not_of(digits);
    const bool has_unit = unit != std::string::npos;
    const bool is_size = unit > 0 && (!has_unit || text.find_first_of(digits, unit) == std::string::npos); // not 0x10KiB
    double bytes = 0;
    try {
        std::string number = text;
        if (is_size && CLI::AsSizeValue(false)(number).empty()) bytes = std::strtod(number.c_str(), nullptr);
    } catch (const CLI::Error&) {
    }
    if (bytes > 0 && (has_unit || bytes >= 1048576)) return bytes;
    throw Failure(ExitCode::usage,
                  error_at(1239, "",
                           bytes > 0 ? fmt::format("--memory {} has no unit: it would be {} bytes", text, text)
                                     : fmt::format("--memory {} is no size", excerpt(text)),
                           "write it as 500MiB or 16GiB"));
}

void print_plan(const BatchArguments& a, const std::vector<BatchJob>& jobs)
{
    if (a.talk.is_quiet) return;
    print_to(a.is_json ? stderr : stdout, "{}", plan_table(jobs));
    std::fflush(stdout); // before the first progress on the other stream
}

ExitCode run_bake_all(const BatchArguments& a)
{
    require_suffix("--report", a.report, ".json");
    const double memory = a.memory.empty() ? memory_share * available_memory() : bytes_of(a.memory);
    const auto start = std::chrono::steady_clock::now();
    std::vector<BatchJob> jobs = read_manifest(a.manifest, threads_for_each(a.job_count), a.report);
    keep_only(jobs, a.only);
    try_outputs({ a.report }, { a.manifest });
    BatchOptions options;
    options.job_count = a.job_count;
    options.memory = memory;
    options.is_fail_fast = a.is_fail_fast;
    options.is_quiet = a.talk.is_quiet;
    options.is_verbose = a.talk.is_verbose;
    judge_stamps(jobs, a.is_forced); // may take long, and an interrupt still ends the process at once
    options.wake = catch_interrupts();

    bool goes_on = plan_batch(jobs, options);
    const bool has_work
        = std::any_of(jobs.begin(), jobs.end(), [](const BatchJob& job) { return job.outcome == Outcome::pending; });
    if (a.is_dry_run || has_work) print_plan(a, jobs); // else the summary says the same
    if (goes_on && !a.is_dry_run) goes_on = run_batch(jobs, options);
    for (BatchJob& job : jobs) read_figures(job);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const ExitCode code = goes_on ? ExitCode(exit_code_of(jobs)) : ExitCode::interrupted;
    const Json summary = summary_json(jobs, seconds, int(code));
    if (!a.report.empty()) write_output(a.report, json_text(summary) + "\n");
    if (a.is_json)
        print_to(stdout, "{}\n", json_text(summary));
    else if (!a.is_dry_run && !a.talk.is_quiet)
        print_to(stdout, "{}", summary_table(jobs));
    return code;
}

void add_what_to_do(CLI::App& verb, BatchArguments& a)
{
    verb.add_flag("--dry-run", a.is_dry_run, "Print the plan and bake nothing");
    verb.add_flag("--force", a.is_forced, "Also bake assets that are up to date");
    verb.add_option("--only", a.only, "Bake only the one with this name; may be given several times")
        ->type_name("NAME")
        ->allow_extra_args(false);
    CLI::Option* keep_going
        = verb.add_flag("--keep-going", a.is_keep_going, "Continue with the other bakes if one fails (the default)");
    verb.add_flag("--fail-fast", a.is_fail_fast, "Start no further bake after the first failure")->excludes(keep_going);
}

} // namespace

Verb add_bake_all(CLI::App& app)
{
    auto a = std::make_shared<BatchArguments>();
    CLI::App* verb = app.add_subcommand("bake-all", "Bake all characters of a manifest that are not up to date");
    verb->footer(
        "Example:\n  pliant bake-all characters.json --jobs 4 --memory 16GiB\n"
        "with characters.json\n"
        "  { \"defaults\": { \"tolerance_max\": 0.01 },\n"
        "    \"bakes\": [ { \"name\": \"hero\", \"poses\": [\"rest.ply\", \"run.ply\"] },\n"
        "               { \"name\": \"troll\", \"config\": \"troll.json\" } ] }\n"
        "Keys are the options of `pliant bake` with '_' for '-'; paths are relative to the folder of the manifest. An asset "
        "is up to date if\n"
        "its stamp (NAME.pliant.stamp) records the same inputs, options and version; file times do not matter. Each bake "
        "runs in its own\n"
        "process: you can interrupt bake-all and start it again, finished bakes are kept. Exit codes: 0 success, 1 a bake "
        "failed, 4 only\n"
        "tolerances were missed, 130 interrupted.");
    verb->add_option("manifest", a->manifest, "JSON file with all bakes (schema: bake_manifest.schema.json)")
        ->required()
        ->type_name("MANIFEST.json");
    verb->add_option("-j,--jobs", a->job_count, "Number of bakes at the same time; each gets its share of the cores")
        ->transform(whole_number_in(1, 256))
        ->capture_default_str();
    verb->add_option(
            "--memory", a->memory,
            "Memory that all running bakes together may use, by their estimates (see `pliant check`), such as 500MiB or "
            "16GiB; other bakes wait (default: 80 % of the memory of the machine or container)")
        ->type_name("SIZE");
    add_what_to_do(*verb, *a);
    verb->add_option("--report", a->report, "Also write the summary as JSON")->type_name("OUT.json");
    verb->add_flag("--json", a->is_json, "Print the summary as JSON to standard output and the plan to standard error");
    add_talk(*verb, a->talk);
    return [a] { return run_bake_all(*a); };
}

} // namespace pliant
