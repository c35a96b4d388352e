#include "checks.h"

#include "options.h"

namespace pliant {

void report_warnings(const std::vector<Diagnostic>& warnings, Progress& progress)
{
    for (const Diagnostic& w : warnings) progress.warn(w.number, w.where.empty() ? w.what : w.where + ": " + w.what, w.hint);
}

PoseSet check(const SourcePoses& poses, const EnergyOptions& options, std::vector<Diagnostic>& warnings, Progress& progress)
{
    LoadOptions load = load_options(options);
    load.share_frame = poses.share_frame;
    PoseSet out = check_poses(poses.meshes, load, &warnings);
    report_warnings(warnings, progress);
    return out;
}

} // namespace pliant
