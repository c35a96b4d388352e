#include "cli/usage_error.h"

#include "cli/help_format.h"
#include "input/io/source_file.h"
#include "pipeline/json_file.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <sstream>
#include <utility>

namespace pliant {
namespace {

std::vector<std::string> option_names(const CLI::App& verb)
{
    std::vector<std::string> names;
    for (const CLI::Option* option : verb.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back(name);
    return names;
}

// The first word that nobody took.
std::string extra_word(const CLI::App& app)
{
    const std::vector<std::string> words = app.remaining(true);
    return words.empty() ? std::string() : words.front();
}

// Words that look like verbs, and what does their work.
constexpr std::pair<const char*, const char*> other_words[] = {
    { "version", "pliant --version" },
    { "man", "pliant help --man" },
    { "completion", "pliant help --completion bash" },
    { "completions", "pliant help --completion bash" },
};

Diagnostic unknown_verb(const CLI::App& app, const std::string& word)
{
    std::vector<std::string> names = verb_names(app);
    for (const auto& [name, command] : other_words) names.push_back(name);
    const std::string nearest = nearest_word(word, names);
    std::string command = "pliant " + nearest;
    for (const auto& [name, other] : other_words)
        if (nearest == name) command = other;
    return error_at(1101, "", fmt::format("there is no verb {}", excerpt(word)),
                    nearest.empty() ? "`pliant --help` lists the verbs" : fmt::format("did you mean `{}`?", command));
}

std::string without_value(const std::string& word) { return word.substr(0, word.find('=')); }

// A word that begins with '-' and that neither the tool nor its verb knows; `verb` may be null.
Diagnostic unknown_option(const CLI::App& app, const CLI::App* verb, const std::string& word)
{
    const std::string option = without_value(word);
    const std::string verb_name = verb ? verb->get_name() : "VERB";
    if (verb && verb->get_option_no_throw(option))
        return error_at(1101, "", fmt::format("option {} stands before the verb", excerpt(option)),
                        fmt::format("options come after the verb: pliant {} {} ...", verb_name, option));
    const std::string name = option.substr(std::min(option.find_first_not_of('-'), option.size()));
    const std::string nearest = nearest_word(name, option_names(verb ? *verb : app));
    std::string hint = fmt::format("`pliant {} --help` lists the options", verb_name);
    if (!nearest.empty())
        hint = fmt::format("did you mean --{}?", nearest);
    else if (!verb)
        hint = "a verb comes first, then its options: `pliant --help` lists the verbs";
    return error_at(1101, "", fmt::format("there is no option {}", excerpt(option)), hint);
}

// The option that a text of the parser begins with, or null.
const CLI::Option* named_option(const CLI::App& verb, std::string text)
{
    const std::string prefix = "Could not convert: ";
    if (text.rfind(prefix, 0) == 0) text.erase(0, prefix.size());
    text = text.substr(0, text.find_first_of(": "));
    for (const CLI::Option* option : verb.get_options())
        if (option->get_name() == text) return option;
    return nullptr;
}

std::string example_of(const CLI::App& verb)
{
    std::istringstream lines(verb.get_footer());
    for (std::string line; std::getline(lines, line);) // "  pliant bake rest.ply run.ply", what it does behind it
        if (line.rfind("  pliant ", 0) == 0) return line.substr(2, line.find("  ", 2) - 2);
    return fmt::format("pliant {} --help", verb.get_name());
}

Diagnostic missing_argument(const CLI::App& verb, const CLI::Option& option)
{
    const std::string type = shown_value(option).type;
    const std::string name = option.get_positional() ? type : option.get_name() + " " + type;
    return error_at(1101, "", fmt::format("{} is missing", name), fmt::format("for example: {}", example_of(verb)));
}

Diagnostic missing_value(const CLI::App& verb, const CLI::Option& option)
{
    const std::string name = option.get_name(), type = shown_value(option).type;
    return error_at(1101, "", type.empty() ? name + " takes no value" : fmt::format("{} needs a value, {}", name, type),
                    fmt::format("`pliant {} --help` explains it", verb.get_name()));
}

// One that took the option behind it for its value, or null.
const CLI::Option* option_without_value(const CLI::App& verb)
{
    for (const CLI::Option* option : verb.get_options())
        for (const std::string& value : option->results())
            if (value.size() > 1 && value[0] == '-' && verb.get_option_no_throw(value)) return option;
    return nullptr;
}

Diagnostic wrong_count(const CLI::App& verb, const CLI::Option& option)
{
    if (option.count() < 2) return missing_value(verb, option);
    return error_at(1101, "", fmt::format("{} is given {} times", option.get_name(), option.count()), "give it once");
}

// "'abc' is not a number", "2.5 is not a whole number", "300 is out of range".
std::string fault_of_number(const CLI::Option& option, const std::string& text)
{
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (text.empty() || rest != end || error == std::errc::invalid_argument) return excerpt(text) + " is not a number";
    const bool is_whole = text.find_first_not_of("-0123456789") == std::string::npos;
    return text + (takes_whole_numbers(option) && !is_whole ? " is not a whole number" : " is out of range");
}

Diagnostic wrong_value(const CLI::App& verb, const CLI::Option& option)
{
    const std::string value = option.results().empty() ? "" : option.results().back();
    const OptionValue takes = shown_value(option);
    if (takes.type.empty()) return missing_value(verb, option);
    const std::string fault
        = takes.choices.empty() ? fault_of_number(option, value) : excerpt(value) + " is not one of its values";
    const std::string nearest = nearest_word(value, takes.choices);
    return error_at(1101, "", option.get_name() + ": " + fault,
                    nearest.empty() ? fmt::format("it takes {}", allowed_values(option))
                                    : fmt::format("did you mean {}?", nearest));
}

Diagnostic exclusion(const std::string& text)
{
    const std::string between = " excludes ";
    const std::size_t at = text.find(between);
    return error_at(1101, "",
                    fmt::format("{} and {} exclude each other", text.substr(0, at), text.substr(at + between.size())),
                    "leave one of them out");
}

} // namespace

std::vector<std::string> verb_names(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::App* verb : app.get_subcommands({})) names.push_back(verb->get_name());
    return names;
}

const CLI::App* chosen_verb(const CLI::App& app)
{
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    return chosen.empty() ? nullptr : chosen.front();
}

const CLI::App& find_verb(const CLI::App& app, const std::string& name)
{
    for (const CLI::App* verb : app.get_subcommands({}))
        if (verb->get_name() == name) return *verb;
    throw Failure(ExitCode::usage, unknown_verb(app, name));
}

Diagnostic usage_error(const CLI::App& app, const CLI::ParseError& error)
{
    const std::string word = extra_word(app), kind = error.get_name();
    const CLI::App* const verb = chosen_verb(app);
    if (word.size() > 1 && word[0] == '-') return unknown_option(app, verb, word);
    if (!verb) return unknown_verb(app, word);
    if (const CLI::Option* option = option_without_value(*verb)) return missing_value(*verb, *option);
    if (!word.empty())
        return error_at(1101, "", fmt::format("argument {} is superfluous", excerpt(word)),
                        fmt::format("`pliant {} --help` lists the arguments", verb->get_name()));
    if (kind == "ExcludesError") return exclusion(error.what());
    if (const CLI::Option* option = named_option(*verb, error.what())) {
        if (kind == "RequiredError") return missing_argument(*verb, *option);
        return kind == "ArgumentMismatch" ? wrong_count(*verb, *option) : wrong_value(*verb, *option);
    }
    return error_at(1101, "", error.what(), fmt::format("`pliant {} --help` lists the arguments", verb->get_name()));
}

} // namespace pliant
