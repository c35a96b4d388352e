// How many elements, and whether a dead load: decided by the error of blends, not by the residual of a fit.
#pragma once

#include "reduce/blend_model.h"
#include "reduce/cubature.h"

namespace pliant {

struct StandInOptions {
    double tolerance = 1e-3;       // wanted total error, mean over the checks
    double tolerance_max = 0;      // and the largest; 0: three times the tolerance is aimed at
    std::size_t element_count = 0; // 0: as few as keep the tolerance, four to twelve per dimension
    std::uint64_t seed = 1;
};

struct StandInReport {
    Curvature curvature;
    double residual = 0;   // of the cubature fit
    BlendError plain;      // over the checks, without the dead load
    BlendError loaded;     // with it; zeros if the stand-in is not convex
    bool has_load = false; // kept: mean and largest error fall
};

// Cubature of growing size until the blends at the checks keep the tolerance, or more elements do not help.
BlendModel choose_cubature(const ReducedEnergy& reduced, const ShapeSet& set, const TrainingSet& training,
                           const std::vector<CheckPoint>& checks, const StandInOptions& options, Progress* progress,
                           StandInReport& report);

// The model of a given stand-in; with a dead load if `may_load` and it helps.
BlendModel fit_model(std::shared_ptr<const StandIn> stand_in, const Subspace& subspace, const ShapeSet& set,
                     const TrainingSet& training, const std::vector<CheckPoint>& checks, bool may_load,
                     StandInReport& report);

} // namespace pliant
