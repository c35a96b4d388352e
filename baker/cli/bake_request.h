// What `pliant bake` is asked for: the same options on its command line, in a configuration file, and in a manifest of many
// bakes.
#pragma once

#include "bake/options.h"
#include "cli/console.h"
#include "input/io/read_log.h"
#include "pipeline/json_file.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pliant {

struct BakeRequest {
    std::vector<std::string> poses, ranges;
    std::string output, report, surface, depfile, stamp, config;
    std::vector<ReadFile> config_files; // the configuration, as it was read
    std::string subspace = "adaptive", surrogate = "auto";
    BakeOptions bake;
    bool has_tolerance = false, is_best_effort = false, is_preview = false;
    bool is_json = false, is_dry_run = false, is_print_config = false;
    Talk talk;
};

// Registers all options that a configuration may have. `request` must outlive the verb.
void add_bake_options(CLI::App& verb, BakeRequest& request);

// Brings the configuration file, if there is one, and names of enumerations into a parsed request. Throws Failure: P27xx
// (bad_input), P1301, P1302 (usage: no poses, no output).
void complete_request(CLI::App& verb, BakeRequest& request);

} // namespace pliant
