#include "pipeline/batch.h"

#include "bake/certificate.h"
#include "base/common/diagnostics.h"
#include "base/common/version.h"
#include "input/io/source_file.h"
#include "output/asset/runtime_blender.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace pliant {
namespace {

std::size_t name_width(const std::vector<BatchJob>& jobs)
{
    std::size_t width = 4;
    for (const BatchJob& job : jobs) width = std::max(width, job.name.size());
    return width;
}

bool has_asset(const BatchJob& job) { return job.file_size > 0; }

// Whether the output is what this bake has made. One that names an error has left an older one.
bool is_of_bake(const BatchJob& job)
{
    return job.outcome == Outcome::up_to_date || job.outcome == Outcome::baked
        || (job.outcome == Outcome::misses_tolerance && job.error_number == 0);
}

std::string or_dash(bool is_known, const std::string& text) { return is_known ? text : "-"; }

Json measured_json(const BatchJob& job)
{
    Json json = Json::object();
    if (!has_asset(job)) return json;
    json["file_size"] = job.file_size;
    json["dimension"] = job.dimension;
    json["elements"] = job.elements;
    if (job.has_error) {
        json["mean_error"] = job.mean_error;
        json["largest_error"] = job.largest_error;
    }
    return json;
}

} // namespace

std::string size_text(double bytes)
{
    constexpr double mebibyte = 1048576.0, gibibyte = 1073741824.0;
    if (bytes >= gibibyte) return fmt::format("{:.1f} GiB", bytes / gibibyte);
    return bytes >= mebibyte ? fmt::format("{:.1f} MiB", bytes / mebibyte) : fmt::format("{:.1f} KiB", bytes / 1024);
}

std::string name_of(Outcome outcome)
{
    switch (outcome) {
    case Outcome::pending: return "to be baked";
    case Outcome::up_to_date: return "up to date";
    case Outcome::baked: return "baked";
    case Outcome::misses_tolerance: return "misses tolerance";
    case Outcome::failed: return "failed";
    case Outcome::crashed: return "crashed";
    case Outcome::too_large: return "too large";
    case Outcome::interrupted: return "interrupted";
    default: return "not started";
    }
}

void read_figures(BatchJob& job)
{
    std::error_code error;
    if (!is_of_bake(job) || !std::filesystem::exists(job.output, error)) return;
    try {
        const RuntimeBlender blender = RuntimeBlender::from_file(job.output);
        job.file_size = double(blender.asset().blob_size);
        job.dimension = long(blender.asset().dimension);
        const Json certificate = Json::parse(blender.certificate(), nullptr, false);
        job.elements = certificate.at("stand_in").at("elements").get<long>();
        const Json& measured = certificate.at("measured");
        job.has_error = !measured.at("checks").empty();
        job.mean_error = measured.at("mean_error").get<double>();
        job.largest_error = measured.at("largest_error").get<double>();
    } catch (const std::exception&) {
        // Somebody else has put another file there meanwhile: the table then knows less.
        job.has_error = false;
    }
}

int exit_code_of(const std::vector<BatchJob>& jobs)
{
    bool is_interrupted = false, misses = false, fails = false;
    for (const BatchJob& job : jobs) {
        is_interrupted = is_interrupted || job.outcome == Outcome::interrupted;
        misses = misses || job.outcome == Outcome::misses_tolerance;
        fails = fails || job.outcome == Outcome::failed || job.outcome == Outcome::crashed
            || job.outcome == Outcome::too_large || job.outcome == Outcome::not_started;
    }
    if (is_interrupted) return int(ExitCode::interrupted);
    return int(fails ? ExitCode::failed : misses ? ExitCode::misses_tolerance : ExitCode::done);
}

std::string plan_table(const std::vector<BatchJob>& jobs)
{
    const std::size_t width = name_width(jobs);
    std::string text
        = fmt::format("{:<{}}  {:<16} {:>4} {:>8} {:>10}  why\n", "name", width, "plan", "d", "seconds", "memory");
    double seconds = 0, memory = 0;
    std::size_t count = 0;
    for (const BatchJob& job : jobs) {
        const bool is_estimated = job.estimated_memory > 0;
        text += fmt::format("{:<{}}  {:<16} {:>4} {:>8} {:>10}  {}\n", job.name, width, name_of(job.outcome),
                            or_dash(is_estimated, std::to_string(job.estimated_dimension)),
                            or_dash(is_estimated, fmt::format("{:.0f}", job.estimated_seconds)),
                            or_dash(is_estimated, size_text(job.estimated_memory)), printable(job.reason));
        if (job.outcome != Outcome::pending) continue;
        seconds += job.estimated_seconds;
        memory = std::max(memory, job.estimated_memory);
        ++count;
    }
    return text
        + fmt::format("{} of {} to be baked; estimate: {:.0f} s of work, at most {} of memory per bake\n", count,
                      jobs.size(), seconds, size_text(memory));
}

std::string summary_table(const std::vector<BatchJob>& jobs)
{
    const std::size_t width = name_width(jobs);
    std::string text = fmt::format("{:<{}}  {:<16} {:>4} {:>8} {:>9} {:>10} {:>8}\n", "name", width, "outcome", "d",
                                   "elements", "error", "size", "seconds");
    for (const BatchJob& job : jobs) {
        text += fmt::format(
            "{:<{}}  {:<16} {:>4} {:>8} {:>9} {:>10} {:>8}\n", job.name, width, name_of(job.outcome),
            or_dash(has_asset(job), std::to_string(job.dimension)), or_dash(has_asset(job), std::to_string(job.elements)),
            or_dash(job.has_error, fmt::format("{:.2e}", job.mean_error)), or_dash(has_asset(job), size_text(job.file_size)),
            or_dash(job.seconds > 0, fmt::format("{:.1f}", job.seconds)));
        if (job.error_number) text += fmt::format("{:<{}}  P{}: {}\n", "", width, job.error_number, job.error);
    }
    return text;
}

Json summary_json(const std::vector<BatchJob>& jobs, double seconds, int exit_code)
{
    Json bakes = Json::array();
    for (const BatchJob& job : jobs) {
        Json json = { { "name", job.name }, { "output", job.output }, { "outcome", name_of(job.outcome) } };
        json["exit_code"] = job.exit_code;
        if (job.signal != 0) json["signal"] = job.signal;
        if (!job.reason.empty()) json["reason"] = job.reason;
        if (job.error_number) json["error"] = { { "number", job.error_number }, { "what", job.error } };
        if (job.estimated_memory > 0)
            json["estimate"] = { { "dimension", job.estimated_dimension },
                                 { "seconds", job.estimated_seconds },
                                 { "memory", job.estimated_memory } };
        if (job.seconds > 0) {
            json["seconds"] = job.seconds;
            json["peak_memory"] = job.peak_memory;
        }
        json.update(measured_json(job));
        bakes.push_back(json);
    }
    return {
        { "bake_all", 1 }, { "baker", baker_version }, { "exit_code", exit_code }, { "seconds", seconds }, { "bakes", bakes }
    };
}

} // namespace pliant
