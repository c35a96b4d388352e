#include "cli/help_format.h"

#include <algorithm>
#include <fmt/format.h>
#include <sstream>

namespace pliant {
namespace {

constexpr std::size_t help_width = 100, text_column = 28;

// Words of `text` in lines that begin at text_column; `line` is what stands before it.
std::string in_columns(std::string line, const std::string& text)
{
    std::string out;
    if (line.size() + 2 > text_column) {
        out = line + "\n";
        line.clear();
    }
    line.resize(text_column, ' ');
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        const bool is_first = line.size() == text_column && line.back() == ' ';
        if (!is_first && line.size() + 1 + word.size() > help_width) {
            out += line + "\n";
            line.assign(text_column, ' ');
        } else if (!is_first) {
            line += ' ';
        }
        line += word;
    }
    return out + line + "\n";
}

struct OptionGroup {
    const char* name;
    std::vector<const char*> options;
};

// In the order in which help shows them. The first, that of CLI11, has all options that are not named here.
const std::vector<OptionGroup>& option_groups()
{
    static const std::vector<OptionGroup> groups = {
        { "Options", {} },
        { "Input", { "--no-align", "--weld", "--fix", "--surface", "--no-scene" } },
        { "Material", { "--material", "--poisson", "--continuity", "--membrane", "--thickness", "--foldover-damping" } },
        { "Quality",
          { "--tolerance", "--tolerance-max", "--best-effort", "--preview", "--time-limit", "--position-error",
            "--check-samples", "--fresh-samples" } },
        { "Build systems", { "--config", "--print-config", "--dry-run", "--report", "--depfile", "--stamp" } },
        { "Run", { "--threads", "--json", "--quiet", "--verbose" } },
        { "Method, for experiments",
          { "--subspace", "--dim", "--ritz", "--energy", "--elements", "--cubature", "--ghost-vertices", "--solver",
            "--seed" } },
    };
    return groups;
}

std::string in_groups(const CLI::App& app, const HelpFormat& format)
{
    std::string out;
    for (const OptionGroup& group : option_groups()) {
        const auto options = app.get_options(
            [&](const CLI::Option* option) { return option->get_group() == group.name && option->nonpositional(); });
        if (!options.empty()) out += format.make_group(group.name, false, options);
    }
    return out;
}

std::string joined(const std::vector<std::string>& words, const char* between)
{
    return fmt::format("{}", fmt::join(words, between));
}

} // namespace

void group_options(CLI::App& app)
{
    for (CLI::App* verb : app.get_subcommands({}))
        for (const OptionGroup& group : option_groups())
            for (const char* name : group.options)
                if (CLI::Option* option = verb->get_option_no_throw(name)) option->group(group.name);
}

// CLI11 writes types as "FLOAT:FLOAT in [0 - 1]" and "NAME:{auto,off}", the checks behind the colon.
OptionValue shown_value(const CLI::Option& option)
{
    OptionValue value;
    if (option.get_items_expected_max() == 0) return value;
    const std::string type = option.get_type_name();
    const std::size_t colon = type.find(':');
    value.type = type.substr(0, colon);
    value.fallback = option.get_default_str();
    const std::string check = colon == std::string::npos ? "" : type.substr(colon + 1);
    if (check.size() > 2 && check.front() == '{' && check.back() == '}')
        value.choices = CLI::detail::split(check.substr(1, check.size() - 2), ',');
    else if (const std::size_t range = check.find(" in ["); range != std::string::npos)
        value.type += check.substr(range);
    if (!value.choices.empty()) value.type = joined(value.choices, "|");
    return value;
}

bool takes_whole_numbers(const CLI::Option& option)
{
    const std::string type = option.get_type_name();
    return type.rfind("INT", 0) == 0 || type.rfind("UINT", 0) == 0 || type.find(":INT") != std::string::npos
        || type.find(":UINT") != std::string::npos;
}

std::string allowed_values(const CLI::Option& option)
{
    const OptionValue value = shown_value(option);
    if (!value.choices.empty()) return joined(value.choices, ", ");
    const std::size_t open = value.type.find(" in ["), dash = value.type.find(" - ");
    if (open != std::string::npos && dash != std::string::npos)
        return value.type.substr(open + 5, dash - open - 5) + " to "
            + value.type.substr(dash + 3, value.type.size() - dash - 4);
    return takes_whole_numbers(option) ? "a whole number" : "another value";
}

std::string HelpFormat::make_option(const CLI::Option* option, bool is_positional) const
{
    const OptionValue value = shown_value(*option);
    std::string left = "  "
        + (is_positional ? option->get_name(true) : joined(CLI::detail::split(option->get_name(false, true), ','), ", "));
    if (!value.type.empty()) left += " " + value.type;
    std::string text = option->get_description();
    if (option->get_required() && !is_positional) text += " (required)";
    if (!value.fallback.empty()) text += " (default: " + value.fallback + ")";
    return in_columns(left, text);
}

std::string HelpFormat::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const
{
    return make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) + in_groups(*app, *this)
        + make_subcommands(app, mode) + "\n" + make_footer(app);
}

std::string HelpFormat::make_subcommand(const CLI::App* verb) const
{
    return in_columns("  " + verb->get_name(), verb->get_description());
}

} // namespace pliant
