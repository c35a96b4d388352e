// The manual page and the completions of shells, made from the parser's own options and texts.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pliant {

// pliant.1 in troff (man macros): every verb with its options and examples.
std::string manual_page(const CLI::App& app);

// A script that completes verbs, options and their words. shell: "bash", "zsh" or "fish".
std::string completion(const CLI::App& app, const std::string& shell);

} // namespace pliant
