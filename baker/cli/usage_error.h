// What is wrong with a command line.
#pragma once

#include "base/common/diagnostics.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pliant {

// P1101: names the word at fault and, of verbs and options, the nearest one that there is.
Diagnostic usage_error(const CLI::App& app, const CLI::ParseError& error);

std::vector<std::string> verb_names(const CLI::App& app);

// The verb that was parsed, or null.
const CLI::App* chosen_verb(const CLI::App& app);

// The verb of this name. Throws Failure (usage, P1101) naming the nearest one.
const CLI::App& find_verb(const CLI::App& app, const std::string& name);

} // namespace pliant
