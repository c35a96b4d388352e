#include "pipeline/stamp.h"

#include "bake/certificate.h"
#include "base/common/sha256.h"
#include "base/common/version.h"
#include "input/io/read_log.h"
#include "input/io/source_file.h"
#include "input/poses/pose_source.h"

#include <filesystem>
#include <fmt/format.h>
#include <system_error>

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr int stamp_version = 2; // 1 could name a position error that was not in force

fs::path folder_of(const std::string& file) { return named_place(file).parent_path(); }

std::string seen_from(const fs::path& folder, const std::string& path)
{
    return named_place(path).lexically_relative(folder).string();
}

// Of a pose from glTF the file alone is a path.
std::string pose_seen_from(const fs::path& folder, const std::string& pose)
{
    const PoseArgument argument = split_pose_argument(pose);
    return seen_from(folder, argument.path) + pose.substr(argument.path.size());
}

// Of the place that links lead to.
std::string link_digest(const fs::path& folder, const std::string& place)
{
    if (place.empty()) return "";
    std::error_code ignored;
    return sha256_hex("leads to " + fs::path(place).lexically_relative(fs::weakly_canonical(folder, ignored)).string());
}

std::string digest_of(const std::string& path)
{
    DiagnosticList diagnostics;
    const std::optional<std::string> bytes = read_bytes(path, diagnostics);
    return bytes ? sha256_hex(*bytes) : "";
}

// The stamp as JSON; null if there is none of ours.
Json read_stamp(const std::string& path)
{
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return {};
    try {
        return read_json_file(path);
    } catch (const Failure&) {
        return {};
    }
}

// The name of an input that is not what it was; empty if all are.
std::string changed_input(const Json& inputs, const fs::path& folder)
{
    if (inputs.empty()) return "all inputs";
    for (const Json& input : inputs) {
        const std::string path = input.at("path").get<std::string>();
        const std::string wanted = input.at("sha256").is_null() ? "" : input.at("sha256").get<std::string>();
        const std::string place = (folder / path).lexically_normal().string();
        if (digest_of(place) != wanted && (wanted.empty() || link_digest(folder, link_place(place)) != wanted))
            return fs::path(path).filename().string();
    }
    return {};
}

} // namespace

std::string stamp_path(const std::string& output) { return output + ".stamp"; }

Json stamped_options(const Json& configuration, const std::string& output)
{
    const fs::path folder = folder_of(output);
    Json options = configuration;
    for (const char* key : { "output", "report", "depfile", "stamp", "threads", "quiet", "$schema" }) options.erase(key);
    for (Json& pose : options["poses"]) pose = pose_seen_from(folder, pose.get<std::string>());
    for (const char* key : { "fix", "surface" })
        if (options.contains(key)) options[key] = seen_from(folder, options[key].get<std::string>());
    return options;
}

std::string write_stamp(const StampContent& content)
{
    const fs::path folder = folder_of(content.output);
    Json inputs = Json::array();
    for (const ReadFile& file : content.files) {
        Json input = { { "path", seen_from(folder, file.path) }, { "sha256", nullptr } };
        const std::string digest = file.place.empty() ? file.digest : link_digest(folder, file.place);
        if (!digest.empty()) input["sha256"] = digest;
        // JSON holds only names of UTF-8; others are not found again, and count as changed.
        if (Json::parse(json_text(input["path"])) != input["path"]) input["sha256"] = "unknown";
        inputs.push_back(input);
    }
    const Json stamp
        = { { "stamp", stamp_version },    { "baker", baker_version },          { "options", content.options },
            { "inputs", inputs },          { "output", content.output_digest }, { "exit_code", content.exit_code },
            { "seconds", content.seconds } };
    return json_text(stamp) + "\n";
}

StampVerdict check_stamp(const Json& options, const std::string& output)
{
    std::error_code error;
    if (!fs::exists(output, error)) return { "no asset yet" };
    const Json stamp = read_stamp(stamp_path(output));
    if (stamp.is_null()) return { "no stamp" };
    try {
        if (stamp.at("stamp") != stamp_version || stamp.at("baker") != baker_version)
            return { "another version of the baker" };
        if (stamp.at("options") != options) return { "other options" };
        const std::string changed = changed_input(stamp.at("inputs"), folder_of(output));
        if (!changed.empty()) return { changed + " has changed" };
        if (stamp.at("output") != digest_of(output)) return { "the asset has changed" };
        return { "", stamp.at("exit_code").get<int>() };
    } catch (const Json::exception&) {
        return { "the stamp is damaged" };
    }
}

} // namespace pliant
