// Options of a verb as JSON: configuration files and effective configurations. The options themselves say which keys there
// are, of what kind and range, so nothing is told twice. A key is the option's long name with '_' for '-'.
#pragma once

#include "pipeline/json_file.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pliant {

// The keys that a configuration of the verb may have, in the order of --help.
std::vector<std::string> config_keys(const CLI::App& verb);

// Checks keys and kinds of a configuration, and makes its paths seen from the current folder: they were relative to
// `folder`. `where` stands in front of messages. Throws Failure (bad_input): P2704 (unknown key), P2705 (wrong kind).
Json checked_config(const CLI::App& verb, const Json& config, const std::string& where, const std::string& folder);

// Gives a parsed verb the values of a checked configuration; options of the command line stay as they are. Throws Failure
// (bad_input, P2706) for a value out of range.
void apply_config(CLI::App& verb, const Json& config, const std::string& where);

// All options of a parsed verb that have a value, by default or given. --tolerance only if it was given: it is a condition
// then.
Json effective_config(const CLI::App& verb);

// A checked configuration as arguments behind the verb's name.
std::vector<std::string> to_arguments(const Json& config);

} // namespace pliant
