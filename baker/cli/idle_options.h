// Options that change nothing, as the poses or other options leave them no work.
#pragma once

#include "bake/options.h"
#include "base/common/diagnostics.h"

#include <CLI/CLI.hpp>
#include <vector>

namespace pliant {

// P1238 for each option that was given to `verb` and does not apply, printed, and added to `kept`.
void warn_of_idle_options(const CLI::App& verb, const EnergyOptions& energy, bool is_solid, std::vector<Diagnostic>& kept);

} // namespace pliant
