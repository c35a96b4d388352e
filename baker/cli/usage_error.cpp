#include "cli/usage_error.h"

#include "pipeline/json_file.h"

#include <algorithm>
#include <fmt/format.h>

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

Diagnostic unknown_verb(const CLI::App& app, const std::string& word)
{
    const std::string nearest = nearest_word(word, verb_names(app));
    return error_at(1101, "", fmt::format("there is no verb {}", excerpt(word)),
                    nearest.empty() ? "`pliant --help` lists the verbs" : fmt::format("did you mean `pliant {}`?", nearest));
}

Diagnostic unknown_option(const CLI::App& verb, const std::string& word)
{
    const std::string name = word.substr(2, word.find('=') - 2), nearest = nearest_word(name, option_names(verb));
    return error_at(1101, "", fmt::format("there is no option {}", excerpt(word.substr(0, word.find('=')))),
                    nearest.empty() ? fmt::format("`pliant {} --help` lists the options", verb.get_name())
                                    : fmt::format("did you mean --{}?", nearest));
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
    const std::string word = extra_word(app);
    const CLI::App* const verb = chosen_verb(app);
    if (!verb) return unknown_verb(app, word);
    if (word.compare(0, 2, "--") == 0 && word.size() > 2) return unknown_option(*verb, word);
    return error_at(1101, "", error.what(), fmt::format("`pliant {} --help` lists the arguments", verb->get_name()));
}

} // namespace pliant
