// One Newton solver per worker of for_each_task, made when first needed.
#pragma once

#include "elastic/average/newton.h"

#include <memory>
#include <vector>

namespace pliant {

// Memory: a Hessian and its factor for each worker that was used.
class SolverPool {
public:
    // The energy and the set must outlive the pool.
    SolverPool(const Energy& energy, const NormalizedPoses& set, SolverKind kind);

    // The worker's own; distinct workers may call at the same time.
    NewtonSolver& at(std::size_t worker);

    const Energy& energy() const { return energy_; }
    const NormalizedPoses& set() const { return set_; }
    SolverKind kind() const { return kind_; }
    int factorization_count() const; // of all workers

private:
    const Energy& energy_;
    const NormalizedPoses& set_;
    SolverKind kind_;
    std::vector<std::unique_ptr<NewtonSolver>> solvers_;
};

} // namespace pliant
