// Compares a bake with its options: warnings and verdict, the same for the command line and the Python package.
#pragma once

#include "bake/report.h"
#include "base/common/diagnostics.h"
#include "base/common/progress.h"
#include "elastic/average/family.h"

#include <optional>
#include <string>
#include <vector>

namespace pliant {

// Blends that miss the tolerance.
struct ToleranceMiss {
    bool is_asked; // a condition; the default tolerance is an aim
    std::string what, hint;
};

// Empty if the asset keeps the tolerance, if nothing was checked, and if the default tolerance does not apply: where the
// dimension was given, or the subspace is not made to keep one. `has_tolerance`: options.tolerance was asked for.
std::optional<ToleranceMiss> find_miss(const BakeReport& report, const BakeOptions& options, bool has_tolerance);

// P4404, and P4405 with the exit code that belongs to it.
void warn_of(const ToleranceMiss& miss, Progress& progress);
Failure to_failure(const ToleranceMiss& miss);

// Throws Failure (failed, P4303) for an average that did not converge. `frame`: its name in messages with a colon and a
// space, or empty.
void require_convergence(const NewtonResult& result, const NewtonOptions& options, const std::string& frame);

// Throws Failure (failed, P4305) for layers of which no sum was found. `frame` as above.
void require_layered_shape(const NewtonResult& result, const Weights& v, const std::vector<std::string>& pose_names,
                           const std::string& frame);

// What helps where there is more than one way to bend: the hint of P4406.
const char* hint_for_jumps(Material material, bool has_layers);

// P4406 for every jump on the way to an average.
void warn_of_jumps(const FamilyPoint& point, const PoseSet& poses, Material material, const std::string& frame,
                   Progress& progress);

// P4411 where a bake needs more bytes than there are.
void warn_of_memory(double needed, double available, Progress& progress);

// normalize(), with P4413 for poses that were to stay where they are and are aligned.
NormalizedPoses normalize_poses(const PoseSet& poses, const EnergyOptions& energy, Progress& progress);

// P4403: hinges whose bending is damped.
void warn_of_foldover(const InputReport& input, const EnergyOptions& energy, Progress& progress);

// P4406 for every place where averages jump, P4407 for tetrahedra inside out, and what parts of a character have (P4408 to
// P4410).
void warn_of_blends(const BakeReport& report, const PoseSet& poses, Progress& progress);

// Adds to `warnings` what was warned of while baking, with the vertices that it is about.
void add_warnings(const std::vector<Diagnostic>& warned, const BakeReport& report, std::vector<Diagnostic>& warnings);

} // namespace pliant
