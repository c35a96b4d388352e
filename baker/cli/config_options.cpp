#include "cli/config_options.h"

#include "cli/help_format.h"
#include "input/io/source_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace pliant {
namespace {

namespace fs = std::filesystem;

// What an option takes, as its type name on the command line tells.
enum class Kind { flag, number, whole, name, name_list, path, path_list };

Kind option_kind(const CLI::Option& option)
{
    if (option.get_items_expected_max() == 0) return Kind::flag;
    const std::string type = option.get_type_name();
    const auto begins = [&](const char* word) { return type.rfind(word, 0) == 0; };
    if (begins("FLOAT")) return Kind::number;
    if (begins("INT") || begins("UINT")) return Kind::whole;
    if (begins("NAME")) return Kind::name;
    if (begins("RANGE")) return Kind::name_list;
    return option.get_items_expected_max() > 1 ? Kind::path_list : Kind::path;
}

// Options that say what to do now, and belong in no file.
const std::set<std::string> without_key = { "help", "config", "print_config", "dry_run", "json", "verbose" };

std::string key_of(const CLI::Option& option)
{
    std::string key = option.get_lnames().empty() ? option.get_name(true) : option.get_lnames()[0];
    std::replace(key.begin(), key.end(), '-', '_');
    return key;
}

std::vector<const CLI::Option*> options_of(const CLI::App& verb)
{
    std::vector<const CLI::Option*> options = verb.get_options();
    const auto is_left_out = [](const CLI::Option* option) { return without_key.count(key_of(*option)) > 0; };
    options.erase(std::remove_if(options.begin(), options.end(), is_left_out), options.end());
    return options;
}

const CLI::Option* find_option(const CLI::App& verb, const std::string& key)
{
    for (const CLI::Option* option : options_of(verb))
        if (key_of(*option) == key) return option;
    return nullptr;
}

bool is_whole(const Json& value)
{
    if (value.is_number_integer()) return true;
    constexpr double exact = 9007199254740992.0; // 2^53: every whole number below is a double
    return value.is_number_float() && std::abs(value.get<double>()) <= exact && std::trunc(value.get<double>()) == value;
}

std::string seen_from_here(const std::string& path, const std::string& folder)
{
    return folder.empty() || fs::path(path).is_absolute() ? path : (fs::path(folder) / path).string();
}

// A path, or a list of paths, that may not be empty.
Json checked_paths(Kind kind, const std::string& key, const Json& value, const std::string& where, const std::string& folder)
{
    if (kind == Kind::path) {
        const std::string path = value.is_string() ? value.get<std::string>() : "";
        if (path.empty() || path.find('\0') != std::string::npos) fail_wrong_kind(where, key, "the name of a file", value);
        return seen_from_here(path, folder);
    }
    if (!value.is_array()) fail_wrong_kind(where, key, "a list of names of files", value);
    Json paths = Json::array();
    for (const Json& item : value) paths.push_back(checked_paths(Kind::path, key, item, where, folder));
    return paths;
}

Json checked_value(const CLI::Option& option, const Json& value, const std::string& where, const std::string& folder)
{
    const Kind kind = option_kind(option);
    const std::string key = key_of(option);
    switch (kind) {
    case Kind::flag:
        if (!value.is_boolean()) fail_wrong_kind(where, key, "true or false", value);
        return value;
    case Kind::number:
        if (!value.is_number()) fail_wrong_kind(where, key, "a number", value);
        return value;
    case Kind::whole:
        if (!is_whole(value)) fail_wrong_kind(where, key, "a whole number", value);
        return value.is_number_float() ? Json(std::int64_t(value.get<double>())) : value;
    case Kind::name:
        if (!value.is_string()) fail_wrong_kind(where, key, "a string", value);
        return value;
    case Kind::name_list:
        if (!value.is_array() || !std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_string(); }))
            fail_wrong_kind(where, key, "a list of strings", value);
        return value;
    default: return checked_paths(kind, key, value, where, folder);
    }
}

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

void set_option(CLI::Option& option, const Json& value, const std::string& where)
{
    try {
        // The parser would take -1 for the largest number that there is.
        if (option.get_type_name().rfind("UINT", 0) == 0 && text_of(value)[0] == '-') throw CLI::ConversionError("negative");
        if (value.is_array())
            for (const Json& item : value) option.add_result(text_of(item));
        else
            option.add_result(text_of(value));
        option.run_callback();
    } catch (const CLI::ParseError&) {
        throw Failure(ExitCode::bad_input,
                      error_at(2706, where, fmt::format("\"{}\" cannot be {}", key_of(option), value.dump()),
                               fmt::format("it takes {}; `pliant bake --help` explains it", allowed_values(option))));
    }
}

Json value_of(const CLI::Option& option)
{
    const Kind kind = option_kind(option);
    if (kind == Kind::flag) return option.count() > 0 && option.as<bool>(); // --preview=false
    if (kind == Kind::path_list || kind == Kind::name_list) return option.results();
    const std::string text = option.count() > 0 ? option.results().back() : option.get_default_str();
    if (kind != Kind::number && kind != Kind::whole) return text;
    const Json number = Json::parse(text, nullptr, false); // ".5" and "+1" are numbers to the command line only
    return number.is_discarded() ? Json(std::stod(text)) : number;
}

// Whether an option that is not given has a value that a configuration may state with the same effect. A tolerance that is
// given must be met, and the default of the position error follows from the tolerance.
bool has_default_value(const CLI::Option& option)
{
    const std::string key = key_of(option);
    if (option_kind(option) == Kind::flag) return true;
    return !option.get_default_str().empty() && key != "tolerance" && key != "position_error";
}

} // namespace

std::vector<std::string> config_keys(const CLI::App& verb)
{
    std::vector<std::string> keys;
    for (const CLI::Option* option : options_of(verb)) keys.push_back(key_of(*option));
    return keys;
}

Json checked_config(const CLI::App& verb, const Json& config, const std::string& where, const std::string& folder)
{
    Json checked = Json::object();
    for (const auto& [key, value] : config.items()) {
        if (key == "$schema") continue; // editors look for it
        const CLI::Option* option = find_option(verb, key);
        if (!option) fail_unknown_key(where, key, config_keys(verb));
        checked[key] = checked_value(*option, value, where, folder);
    }
    return checked;
}

void apply_config(CLI::App& verb, const Json& config, const std::string& where)
{
    for (CLI::Option* option : verb.get_options()) {
        const std::string key = key_of(*option);
        if (option->count() > 0 || !config.contains(key)) continue;
        if (config[key].is_array() ? !config[key].empty() : config[key] != false) set_option(*option, config[key], where);
    }
}

Json effective_config(const CLI::App& verb)
{
    Json config = Json::object();
    for (const CLI::Option* option : options_of(verb))
        if (option->count() > 0 || has_default_value(*option)) config[key_of(*option)] = value_of(*option);
    return config;
}

std::vector<std::string> to_arguments(const Json& config)
{
    std::vector<std::string> arguments, poses;
    for (const auto& [key, value] : config.items()) {
        std::string option = "--" + key;
        std::replace(option.begin(), option.end(), '_', '-');
        if (value.is_array())
            for (const Json& item : value) {
                if (key == "poses")
                    poses.push_back(item.get<std::string>());
                else
                    arguments.push_back(option + "=" + item.get<std::string>());
            }
        else if (value.is_boolean() && value.get<bool>())
            arguments.push_back(option);
        else if (!value.is_boolean())
            arguments.push_back(option + "=" + text_of(value));
    }
    arguments.push_back("--"); // a pose may be called like an option
    arguments.insert(arguments.end(), poses.begin(), poses.end());
    return arguments;
}

} // namespace pliant
