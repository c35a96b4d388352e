/* The function that a frame minimises: the surrogate energy of the asset, elements or a quartic, combined for the weights of
   the frame, plus its dead load. */
#include "internal.h"
#include "linalg.h"

#include <float.h>
#include <math.h>

pliant_energy_layout pliant_solver_measure_energy(const pliant_asset* asset)
{
    return asset->quartic ? pliant_quartic_measure(asset) : pliant_elements_measure(asset);
}

void pliant_solver_combine(pliant_solver* solver)
{
    const pliant_asset* asset = &solver->asset;
    const size_t size = asset->pose_count * sizeof(float);
    if (solver->is_combined && memcmp(solver->combined_weights, solver->weights, size) == 0) return;
    if (asset->quartic)
        pliant_quartic_combine(solver->kernels, asset, solver->weights, solver->combined);
    else
        pliant_elements_combine(solver->kernels, asset, solver->weights, solver->combined);
    memcpy(solver->combined_weights, solver->weights, size);
    solver->is_combined = 1;
}

static double evaluate_energy(const pliant_solver* solver, const float* z, float* gradient)
{
    const pliant_asset* asset = &solver->asset;
    if (asset->quartic)
        return pliant_quartic_evaluate(solver->kernels, asset, solver->combined, z, gradient, solver->scratch);
    return pliant_elements_evaluate(solver->kernels, asset, solver->weights, solver->combined, z, gradient, solver->scratch);
}

int pliant_solver_evaluate(pliant_solver* solver, const float* z, double* energy, float* gradient)
{
    const size_t d = solver->asset.padded_dimension;
    ++solver->evaluations;
    *energy = evaluate_energy(solver, z, gradient);
    if (solver->load) {
        *energy += (double)pliant_dot(solver->load, z, d);
        pliant_add_scaled(gradient, 1.0f, solver->load, d);
    }
    /* A sum of squares in single precision overflows before anything computed from this point can. */
    const float square = pliant_dot(gradient, gradient, d);
    return fabs(*energy) <= (double)FLT_MAX && pliant_is_finite(square);
}
