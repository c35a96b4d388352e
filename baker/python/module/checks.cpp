#include "checks.h"

#include "options.h"

namespace pliant {

void report_warnings(const std::vector<Diagnostic>& warnings, Progress& progress)
{
    for (const Diagnostic& w : warnings) progress.warn(w.number, w.where.empty() ? w.what : w.where + ": " + w.what, w.hint);
}

PoseSet check(const SourcePoses& poses, const EnergyOptions& options, std::vector<Diagnostic>& warnings, Progress& progress)
{
    PoseSet out = check_poses(poses.meshes, load_options(options), &warnings);
    report_warnings(warnings, progress);
    return out;
}

} // namespace pliant
