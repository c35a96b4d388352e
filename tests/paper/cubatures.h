// The cubature of von Tycowicz et al. 2015, one set of elements for every pose, beside one set for all poses.
#pragma once

#include "reduced.h"

namespace pliant {

struct CubatureStudy {
    std::size_t pose_count = 1000; // training poses of each example pose, as in the paper
    std::size_t points_per_dimension = 3;
    std::size_t candidate_count = 8000; // random elements that compete, the same for all ways
    std::uint64_t seed = 1;
};

// CSV: a row for each way to choose the elements and each reference. Ways: "per pose", trained as in the paper on poses
// drawn around each example pose, and "joint", trained on `training`, each by hard thresholding pursuit and greedily; the
// greedy joint one also with as many elements as all sets per pose have together, and with a dead load. surrogate_l2
// compares a blend with the exact reduced average (columns of `exact`), total_l2 with the reference. Iterations are those
// of BFGS from the surrogate energy's mean, with the inverse Hessian there (the paper's H_0), and with that of the Hessian
// averaged over the training weights. `training_s`: of the training, on all threads.
std::string cubature_rows(const ReducedSolver& reduced, const NormalizedPoses& set, const TrainingSet& training,
                          const std::vector<Reference>& references, const Eigen::MatrixXd& exact,
                          const CubatureStudy& options);

} // namespace pliant
