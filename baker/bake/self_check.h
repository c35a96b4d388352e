// The stage that assembles the asset and checks it: encoded, opened by the C runtime, compared with unreduced averages.
#pragma once

#include "bake/assemble.h"
#include "bake/report.h"

namespace pliant {

// What a check works on. `fit`, `fitted` and their parts must outlive the CheckedAsset.
struct CheckProblem {
    const PoseSet& poses;
    const FitProblem& fit;
    const FittedModel& fitted;
    SolverPool& pool;
};

// The asset that was checked, what is written beside it, and what was found.
struct CheckedAsset {
    AssetModel asset;
    AssetRecord record; // its certificate is not written yet
    CheckReport report;
    std::vector<Branch> branches;
};

// Compares blends of the asset with unreduced averages, at the checks and at weights that nothing was chosen by. Encodes the
// asset once; where it draws another mesh than that of the poses, once with each. Cost: an average for each fresh weight
// (options.fresh_count).
CheckedAsset self_check(const CheckProblem& problem, const BakeOptions& options, Progress& progress);

} // namespace pliant
