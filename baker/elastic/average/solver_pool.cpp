#include "elastic/average/solver_pool.h"

#include "base/common/parallel.h"

namespace pliant {

SolverPool::SolverPool(const Energy& energy, const NormalizedPoses& set, SolverKind kind)
    : energy_(energy)
    , set_(set)
    , kind_(kind)
    , solvers_(worker_count())
{
}

NewtonSolver& SolverPool::at(std::size_t worker)
{
    std::unique_ptr<NewtonSolver>& solver = solvers_.at(worker);
    if (!solver) solver = std::make_unique<NewtonSolver>(energy_, set_, kind_);
    return *solver;
}

int SolverPool::factorization_count() const
{
    int count = 0;
    for (const auto& solver : solvers_)
        if (solver) count += solver->factorization_count();
    return count;
}

} // namespace pliant
