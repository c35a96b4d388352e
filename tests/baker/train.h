// A training set for the small problems of these tests.
#pragma once

#include "elastic/average/newton.h"
#include "reduced/surrogate/training.h"

namespace pliant {

inline TrainingSet train(NewtonSolver& solver, const Subspace& subspace, std::size_t count)
{
    const std::size_t m = solver.set().pose_count();
    const NewtonResult mean = solver.minimize(equal_weights(m), solver.set().shapes[0], NewtonOptions());
    HessianAssembler assembler(solver.energy());
    assembler.assemble(equal_weights(m), mean.y, HessianKind::exact);
    const ReducedSolver reduced(solver.energy(), subspace, assembler.matrix(), mean.energy);
    return solve_training_set(reduced, solver.set(), training_weights(m, count, 1), nullptr);
}

} // namespace pliant
