// An asset as a GLB for engines: morph targets, the asset itself embedded, an animation along a path of weights.
#pragma once

#include "base/common/diagnostics.h"
#include "output/asset/runtime_blender.h"
#include "output/export/export_options.h"

#include <string>
#include <vector>

namespace pliant {

struct ExportedFile {
    std::string bytes;
    ExportReport report;
};

// What of it may not work in some engine: P5202, P5205, P5208.
std::vector<Diagnostic> warnings_about(const ExportReport& report);

// Weights from pose to pose, through the mean and back to the first, eased in and out: `seconds` long. Of layers: from the
// rest shape to each layer at its full strength and back, then to all of them, or the first few if they are many.
std::vector<std::vector<float>> default_path(const WeightDomain& domain, double seconds, double frames_per_second);

// Throws Failure (P5201) if the file would not fit the format, (bad_input, P1203 and P1204) for a path of wrong weights.
ExportedFile export_asset(RuntimeBlender& blender, const ExportOptions& options);

} // namespace pliant
