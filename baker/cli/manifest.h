// A manifest names many bakes: bake_manifest.schema.json.
#pragma once

#include "pipeline/batch.h"

#include <string>
#include <vector>

namespace pliant {

// The bakes of a manifest, in its order: its defaults, the configuration that an entry names, and the entry itself, of which
// the later beat the earlier. Paths become as seen from the current folder. `threads`: for each bake that does not say how
// many. `summary`: the file that will report on all of them, or empty. Throws Failure (bad_input): as read_json_file,
// checked_config and apply_config, P2707 (something is missing), P2708 (a name or an output twice, or an output that a bake
// reads).
std::vector<BatchJob> read_manifest(const std::string& path, unsigned threads, const std::string& summary = {});

} // namespace pliant
