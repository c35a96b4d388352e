// How `--help` looks: options in groups, columns of text that fit into 100 characters.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pliant {

// Sorts the options of all verbs into groups.
void group_options(CLI::App& app);

// "NAME", "auto|off", "0.001": what stands behind an option, what may stand there, what does if nothing is given. Empty
// where there is nothing to say.
struct OptionValue {
    std::string type, fallback;
    std::vector<std::string> choices; // one of these words
};
OptionValue shown_value(const CLI::Option& option);
bool takes_whole_numbers(const CLI::Option& option);

// "1 to 256", "adaptive, krylov", for hints.
std::string allowed_values(const CLI::Option& option);

class HelpFormat : public CLI::Formatter {
public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
    std::string make_option(const CLI::Option* option, bool is_positional) const override;
    std::string make_subcommand(const CLI::App* verb) const override;
};

} // namespace pliant
