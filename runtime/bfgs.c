/* Minimisation of the surrogate energy for one frame: BFGS with a dense inverse Hessian in whitened coordinates, where the
   identity is the right first guess.

   Source: Nocedal, Wright, "Numerical Optimization", 2nd edition, chapters 3 and 6; the use for shape interpolation is von
   Tycowicz et al., "Real-Time Nonlinear Shape Interpolation", TOG 2015, section 6. What differs is what single
   precision asks for, said at each constant. */
#include "internal.h"
#include "linalg.h"

#include <float.h>
#include <math.h>

/* Sufficient decrease (Armijo): the usual value, small enough to accept every reasonable step. */
#define ARMIJO 1e-4

/* A step whose predicted decrease is below PLIANT_ENERGY_NOISE is judged by its slope, which keeps relative accuracy; its
   energy may not rise by more than the noise. It is taken if it brings the slope down to this part (the curvature condition
   of quasi-Newton practice). */
#define SLOPE_REDUCTION 0.9

/* Updates need s.y > this * |s||y|. For a quadratic of condition c the ratio is at least about 2/sqrt(c): what is below
   belongs to a condition number above 4e6, which single precision cannot tell from a flat or a concave direction. */
#define CURVATURE_FLOOR 1e-3f

/* Trials of one line search. Each shortens the step by 2 to 10: 2^-20 of a step is nothing in single precision. */
#define MAX_TRIALS 20

float pliant_bfgs_direction(pliant_solver* solver)
{
    const size_t d = solver->asset.padded_dimension;
    float* PLIANT_RESTRICT direction = solver->direction;
    solver->kernels->combine_columns(direction, solver->inverse_hessian, solver->gradient, solver->asset.dimension, d);
    for (size_t j = 0; j < d; ++j) direction[j] = -direction[j];
    return -pliant_dot(solver->gradient, direction, d);
}

void pliant_bfgs_forget(pliant_solver* solver)
{
    pliant_set_identity(solver->inverse_hessian, solver->asset.dimension, solver->asset.padded_dimension);
    solver->is_identity = 1;
}

/* B <- (I - r s y^T) B (I - r y s^T) + r s s^T with r = 1/(s.y), as one symmetric update B += s v^T + v s^T. */
static void learn_curvature(pliant_solver* solver)
{
    const size_t d = solver->asset.padded_dimension;
    const float* s = solver->step;
    const float* y = solver->change;
    const float sy = pliant_dot(s, y, d);
    const float floor = CURVATURE_FLOOR * sqrtf(pliant_dot(s, s, d)) * sqrtf(pliant_dot(y, y, d));
    if (!(sy > floor)) return;
    solver->kernels->combine_columns(solver->product, solver->inverse_hessian, y, solver->asset.dimension, d);
    const float r = 1.0f / sy;
    const float half = 0.5f * r * (1.0f + r * pliant_dot(y, solver->product, d));
    float* v = solver->change; /* y is not needed any more */
    for (size_t j = 0; j < d; ++j) v[j] = half * s[j] - r * solver->product[j];
    if (!pliant_is_finite(pliant_dot(v, v, d))) return;
    solver->kernels->add_symmetric(solver->inverse_hessian, s, v, d);
    solver->is_identity = 0;
}

/* Moves to the trial point. */
static void accept_trial(pliant_solver* solver, double energy)
{
    const size_t d = solver->asset.padded_dimension;
    float* PLIANT_RESTRICT step = solver->step;
    float* PLIANT_RESTRICT change = solver->change;
    for (size_t j = 0; j < d; ++j) {
        step[j] = solver->trial[j] - solver->z[j];
        change[j] = solver->trial_gradient[j] - solver->gradient[j];
    }
    memcpy(solver->z, solver->trial, d * sizeof(float));
    memcpy(solver->gradient, solver->trial_gradient, d * sizeof(float));
    solver->energy = energy;
}

/* Where to try next after a step of length t failed: the minimum of the parabola through what is known, kept within a
   tenth and a half of t. Below the noise the parabola is that of the slopes. */
static float shorten(float t, double slope, int is_finite, double rise, int by_slope, double new_slope)
{
    if (!is_finite) return 0.25f * t;
    const double bend = by_slope ? (new_slope - slope) / 2.0 : rise / (double)t - slope;
    const double part = bend > 0.0 ? -slope / (2.0 * bend) : 0.5;
    return t * (float)(part < 0.1 ? 0.1 : part > 0.5 ? 0.5 : part);
}

/* Walks along solver->direction, whose slope is negative. 1 and a new point, or 0: no step improves. `ceiling` is the
   energy that the frame must not exceed. */
static int search_line(pliant_solver* solver, double slope, double ceiling)
{
    const size_t d = solver->asset.padded_dimension;
    const double noise = PLIANT_ENERGY_NOISE * (double)solver->asset.energy_scale;
    float t = 1.0f;
    for (int trial = 0; trial < MAX_TRIALS && solver->evaluations < solver->evaluation_limit; ++trial) {
        double energy, new_slope = 0.0;
        pliant_move(solver->trial, solver->z, t, solver->direction, d);
        const int is_finite = pliant_solver_evaluate(solver, solver->trial, &energy, solver->trial_gradient);
        const int by_slope = -slope * (double)t < noise;
        if (is_finite) {
            if (by_slope) new_slope = (double)pliant_dot(solver->trial_gradient, solver->direction, d);
            const int accepted = by_slope ? fabs(new_slope) <= -SLOPE_REDUCTION * slope && energy <= ceiling
                                          : energy <= solver->energy + ARMIJO * (double)t * slope;
            if (accepted) {
                accept_trial(solver, energy);
                return 1;
            }
        }
        t = shorten(t, slope, is_finite, energy - solver->energy, by_slope, new_slope);
    }
    return 0;
}

pliant_status pliant_bfgs_minimise(pliant_solver* solver)
{
    const double scale = (double)solver->asset.energy_scale;
    const double tolerance = (double)solver->desc.tolerance;
    const double ceiling = solver->energy + PLIANT_ENERGY_NOISE * scale;
    for (;;) {
        double square = (double)pliant_bfgs_direction(solver);
        if (!(square >= 0.0 && square <= (double)FLT_MAX)) {
            /* Rounding has cost the matrix its definiteness. The identity cannot lose it, and |g|^2 is finite. */
            pliant_bfgs_forget(solver);
            square = (double)pliant_bfgs_direction(solver);
        }
        if (square <= tolerance * tolerance * scale) return PLIANT_STATUS_CONVERGED;
        if (solver->iterations >= solver->desc.max_iterations || solver->evaluations >= solver->evaluation_limit)
            return PLIANT_STATUS_LIMIT;
        if (search_line(solver, -square, ceiling)) {
            ++solver->iterations;
            learn_curvature(solver);
        } else if (solver->evaluations >= solver->evaluation_limit) {
            return PLIANT_STATUS_LIMIT;
        } else if (solver->is_identity) {
            return PLIANT_STATUS_STALLED;
        } else {
            pliant_bfgs_forget(solver);
        }
    }
}
