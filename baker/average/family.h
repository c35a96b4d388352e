// The family a(w) of averages, defined by continuation, so that every user of it means the same branch.
#pragma once

#include "average/newton.h"

#include <optional>

namespace pliant {

// a(w) is reached along the straight line in weight space from the equal-weight average, which itself is reached from the pose
// whose energy under equal weights is least.
// An elastic average need not be unique; one definition of it is needed where snapshots, truths and measurements are compared.
class AverageFamily {
public:
    AverageFamily(NewtonSolver& solver, NewtonOptions options, Progress* progress);

    // The average for w (non-negative, sum 1), in the gauge of pose 0. Steps of the path are halved when Newton fails; the last
    // result may still not have converged: check it. Cost: 3 to 12 factorisations.
    NewtonResult at(const Weights& w);

    // The equal-weight average, computed once.
    const NewtonResult& mean();

private:
    NewtonResult follow(const Weights& from, const Shape& start, const Weights& to, int step_count);
    NewtonSolver& solver_;
    NewtonOptions options_;
    Progress* progress_;
    std::optional<NewtonResult> mean_;
};

} // namespace pliant
