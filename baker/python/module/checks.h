// Poses of Python compared with each other, and what Python hears of it.
#pragma once

#include "arrays.h"

#include "bake/options.h"
#include "base/common/diagnostics.h"
#include "base/common/progress.h"

namespace pliant {

// Python hears of warnings by number, text and hint; where they are in a file stands in front of the text.
void report_warnings(const std::vector<Diagnostic>& warnings, Progress& progress);

// The poses as the baker works on them; `warnings` holds those that were reported. Throws Failure (bad_input).
PoseSet check(const SourcePoses& poses, const EnergyOptions& options, std::vector<Diagnostic>& warnings, Progress& progress);

} // namespace pliant
