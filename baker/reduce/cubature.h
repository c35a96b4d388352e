// Optimised cubature: a few elements with non-negative weights stand for all of them (An, Kim, James 2008; von Tycowicz et al. 2013).
#pragma once

#include "reduce/training.h"

namespace pliant {

struct CubatureOptions {
    std::size_t element_count = 0;       // 0: six per dimension
    std::size_t candidate_count = 16000; // random elements that compete
    std::uint64_t seed = 1;
};

struct CubatureReport {
    double residual = 0; // relative, of the whitened and weighted training rows
    double lowest_curvature
        = 0; // smallest eigenvalue of S^T H_standin S over all training weights; 1 is perfect, <= 0 useless
    double highest_curvature = 0;
    std::size_t candidate_count = 0;
};

// One joint element set for all poses. The fit sees, all whitened by training.root: reduced forces of single poses at averages and of
// combinations at perturbed averages, forces at averages that must cancel (equilibrium), and columns of the Hessian.
StandIn fit_cubature(const ReducedEnergy& reduced, const TrainingSet& training, const CubatureOptions& options,
                     Progress* progress, CubatureReport& report);

// Smallest and largest eigenvalue of S^T H S, H the stand-in's Hessian, over the training averages.
void measure_curvature(const StandIn& stand_in, const TrainingSet& training, double& lowest, double& highest);

} // namespace pliant
