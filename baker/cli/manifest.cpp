#include "cli/manifest.h"

#include "cli/bake_request.h"
#include "cli/config_options.h"
#include "cli/verbs.h"
#include "input/io/source_file.h"
#include "input/poses/pose_source.h"
#include "pipeline/stamp.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <map>

namespace pliant {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(int number, const std::string& where, const std::string& what, const std::string& hint)
{
    throw Failure(ExitCode::bad_input, error_at(number, where, what, hint));
}

std::string folder_of(const std::string& path) { return fs::path(path).parent_path().string(); }

// The options of a bake, where nothing comes from the command line.
struct EmptyBake {
    CLI::App app;
    BakeRequest request;
    EmptyBake() { add_bake_options(app, request); }
};

// Keys that one bake alone can have: what it is of, and files that no two may share.
const std::vector<std::string> own_keys = { "poses", "output", "report", "depfile" };
// bake-all itself sees to these.
const std::vector<std::string> taken_keys = { "stamp", "quiet" };

bool is_one_of(const std::vector<std::string>& keys, const std::string& key)
{
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

// checked_config, with fewer keys and some more.
Json checked_part(const Json& part, const std::string& where, const std::string& folder, bool is_defaults)
{
    const EmptyBake bake;
    std::vector<std::string> known
        = is_defaults ? std::vector<std::string>() : std::vector<std::string> { "name", "config" };
    for (const std::string& key : config_keys(bake.app))
        if (!is_one_of(taken_keys, key) && !(is_defaults && is_one_of(own_keys, key))) known.push_back(key);
    Json options = part;
    for (const auto& [key, value] : part.items()) {
        if (!is_one_of(known, key) && key != "$schema") fail_unknown_key(where, key, known);
        if (key != "name" && key != "config") continue;
        if (!value.is_string() || value.get<std::string>().empty()) fail_wrong_kind(where, key, "a string", value);
        options.erase(key);
    }
    return checked_config(bake.app, options, where, folder);
}

Json read_config(const std::string& path)
{
    const EmptyBake bake;
    return checked_config(bake.app, read_json_file(path), path, folder_of(path));
}

std::string in_folder(const std::string& folder, const std::string& path)
{
    return fs::path(path).is_absolute() || folder.empty() ? path : (fs::path(folder) / path).string();
}

// It becomes a file's name and a line on a terminal.
void check_name(const std::string& name, const std::string& where)
{
    const auto is_bad = [](char c) { return c == '/' || static_cast<unsigned char>(c) < ' ' || c == 127; };
    if (name.empty() || name[0] == '.' || name[0] == '-' || std::any_of(name.begin(), name.end(), is_bad))
        fail(2707, where, fmt::format("{} is no name", excerpt(name)),
             "names have no '/' and no control characters, and begin with neither '.' nor '-'");
}

// Name and output, each from the other where one is missing.
void name_job(BatchJob& job, Json& config, const Json& entry, const std::string& where, const std::string& folder)
{
    if (entry.contains("name")) job.name = entry["name"].get<std::string>();
    if (config.contains("output")) job.output = config["output"].get<std::string>();
    if (job.name.empty() && job.output.empty())
        fail(2707, where, "has neither a name nor an output", "add \"name\": \"...\": the asset is then NAME.pliant");
    if (job.name.empty()) job.name = fs::path(job.output).stem().string();
    check_name(job.name, where);
    if (job.output.empty()) job.output = in_folder(folder, job.name + ".pliant");
    config["output"] = job.output;
}

BatchJob read_entry(const Json& entry, const Json& defaults, const std::string& where, const std::string& folder,
                    unsigned threads)
{
    if (!entry.is_object())
        fail(2705, where, "is " + kind_of(entry) + ", an object expected", "write { \"name\": ..., ... }");
    const Json own = checked_part(entry, where, folder, false);
    Json config = defaults;
    if (entry.contains("config")) config.update(read_config(in_folder(folder, entry["config"].get<std::string>())));
    config.update(own);
    for (const std::string& key : taken_keys) config.erase(key); // of a configuration that is used alone, too

    BatchJob job;
    name_job(job, config, entry, where, folder);
    if (!config.contains("poses") || config["poses"].empty())
        fail(2707, where, fmt::format("the bake {} has no poses", excerpt(job.name)), "add \"poses\": [\"rest.ply\", ...]");
    EmptyBake bake;
    apply_config(bake.app, config, where);
    job.options = stamped_options(effective_config(bake.app), job.output);
    for (const char* key : { "report", "depfile" })
        if (config.contains(key)) job.extras.push_back(config[key].get<std::string>());
    job.inputs = input_files(config["poses"].get<std::vector<std::string>>(), {});
    for (const char* key : { "fix", "surface" })
        if (config.contains(key)) job.inputs.push_back(config[key].get<std::string>());
    if (entry.contains("config")) job.inputs.push_back(in_folder(folder, entry["config"].get<std::string>()));
    config["stamp"] = stamp_path(job.output);
    if (!config.contains("threads")) config["threads"] = threads;
    job.arguments = to_arguments(config);
    return job;
}

void check_names(const std::vector<BatchJob>& jobs, const std::string& path)
{
    std::map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        const auto [other, is_new] = places.emplace(jobs[i].name, i);
        if (!is_new)
            fail(2708, path,
                 fmt::format("bakes[{}] and bakes[{}] have the name {}", other->second, i, excerpt(jobs[i].name)),
                 "give each bake its own name");
    }
}

// No two files that bakes write may be one, nor the manifest, nor what a bake reads.
void check_outputs(const std::vector<BatchJob>& jobs, const std::string& manifest, const std::string& summary)
{
    std::map<fs::path, std::string> owners;
    const auto place_of = [](const std::string& file) {
        std::error_code error; // of a place that cannot be looked up: the bake reports it
        const fs::path place = fs::weakly_canonical(fs::absolute(file), error);
        return error ? fs::absolute(file).lexically_normal() : place;
    };
    const auto take = [&](const std::string& file, const std::string& owner) {
        const auto [other, is_new] = owners.emplace(place_of(file), owner);
        if (!is_new)
            fail(2708, manifest, fmt::format("{} and {} have the output {}", other->second, owner, file),
                 "give each bake its own outputs");
    };
    take(manifest, "the manifest");
    if (!summary.empty()) take(summary, "--report");
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        const std::string owner = fmt::format("bakes[{}]", i);
        take(jobs[i].output, owner);
        take(stamp_path(jobs[i].output), owner);
        for (const std::string& file : jobs[i].extras) take(file, owner);
    }
    for (std::size_t i = 0; i < jobs.size(); ++i)
        for (const std::string& file : jobs[i].inputs)
            if (const auto owner = owners.find(place_of(file)); owner != owners.end())
                fail(2708, manifest, fmt::format("bakes[{}] reads {}, which is written for {}", i, file, owner->second),
                     "give each bake its own outputs");
}

} // namespace

std::vector<BatchJob> read_manifest(const std::string& path, unsigned threads, const std::string& summary)
{
    const Json manifest = read_json_file(path);
    const std::vector<std::string> keys = { "defaults", "bakes" };
    for (const auto& [key, value] : manifest.items())
        if (!is_one_of(keys, key) && key != "$schema") fail_unknown_key(path, key, keys);
    if (!manifest.contains("bakes") || !manifest["bakes"].is_array() || manifest["bakes"].empty())
        fail(2707, path, "has no bakes", "write \"bakes\": [ { \"name\": \"hero\", \"poses\": [...] }, ... ]");
    const std::string folder = folder_of(path);
    Json defaults = Json::object();
    if (manifest.contains("defaults")) {
        if (!manifest["defaults"].is_object()) fail_wrong_kind(path, "defaults", "an object", manifest["defaults"]);
        defaults = checked_part(manifest["defaults"], path + ": defaults", folder, true);
    }
    std::vector<BatchJob> jobs;
    for (const Json& entry : manifest["bakes"])
        jobs.push_back(read_entry(entry, defaults, fmt::format("{}: bakes[{}]", path, jobs.size()), folder, threads));
    check_names(jobs, path);
    check_outputs(jobs, path, summary);
    return jobs;
}

} // namespace pliant
