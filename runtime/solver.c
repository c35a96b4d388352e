/* One character's solver: carving its memory, judging weights, choosing where a frame starts, turning z into q. The
   minimisation itself is in bfgs.c. */
#include "internal.h"

#include <float.h>
#include <math.h>

#define SOLVER_MAGIC 0x504C5356u /* "PLSV": memory that no pliant_solver_init made is refused */

/* Vectors and matrices start at multiples of this: a cache line, and what the widest vectors like. */
#define ALIGNMENT 64u

/* A jump keeps this part of its evaluations for a second descent, from z = 0: enough for one that starts well, and few
   enough not to starve a first descent that is making progress (tests/bench/jumps.c counts both). */
#define SECOND_DESCENT_SHARE 4u

/* With fewer evaluations than this a second descent gets nowhere. */
#define SECOND_DESCENT_LEAST 8u

pliant_solver_desc pliant_solver_desc_default(void)
{
    pliant_solver_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.struct_size = (uint32_t)sizeof desc;
    desc.max_iterations = 60;
    desc.max_evaluations = 120;
    desc.tolerance = 1e-3f;
    desc.continuity = 0.1f;
    return desc;
}

void pliant_solver_desc_init(pliant_solver_desc* out)
{
    if (out) *out = pliant_solver_desc_default();
}

static int is_valid(const pliant_asset* asset, const pliant_solver_desc* desc)
{
    if (!asset || !asset->blob || !desc || desc->struct_size != sizeof *desc) return 0;
    if (desc->max_evaluations < 1) return 0;
    if (!pliant_is_finite(desc->tolerance) || desc->tolerance < 0.0f) return 0;
    return pliant_is_finite(desc->continuity) && desc->continuity >= 0.0f;
}

/* ------------------------------------------------------------------------------------------------------- memory ---- */

/* Hands out pieces of the caller's memory; with base null it only counts. Counting in 64 bits: on a 32-bit machine the
   sum may exceed size_t, which pliant_solver_memory then reports. */
typedef struct carver {
    unsigned char* base;
    uint64_t used;
} carver;

static void* carve(carver* c, uint64_t size)
{
    void* piece = c->base ? c->base + c->used : NULL;
    c->used += (size + (ALIGNMENT - 1)) & ~(uint64_t)(ALIGNMENT - 1);
    return piece;
}

static float* carve_floats(carver* c, uint64_t count) { return (float*)carve(c, count * sizeof(float)); }

/* The one layout: counts (solver null) and carves. */
static void lay_out(carver* c, const pliant_asset* asset, pliant_solver* solver)
{
    const uint64_t d = asset->padded_dimension, m = pliant_pad_lanes(asset->pose_count);
    const pliant_energy_layout energy = pliant_solver_measure_energy(asset);
    pliant_solver counted;
    pliant_solver* s = solver ? solver : &counted;
    s->weights = carve_floats(c, m);
    s->previous_weights = carve_floats(c, m);
    s->z = carve_floats(c, d);
    s->gradient = carve_floats(c, d);
    s->start = carve_floats(c, d);
    s->previous_start = carve_floats(c, d);
    s->previous_z = carve_floats(c, d);
    s->first_z = carve_floats(c, d);
    s->trial = carve_floats(c, d);
    s->trial_gradient = carve_floats(c, d);
    s->direction = carve_floats(c, d);
    s->step = carve_floats(c, d);
    s->change = carve_floats(c, d);
    s->product = carve_floats(c, d);
    s->load = asset->load_coefficients ? carve_floats(c, d) : NULL;
    s->inverse_hessian = carve_floats(c, d * d);
    s->combined = carve_floats(c, energy.combined_floats);
    s->combined_weights = carve_floats(c, m);
    s->scratch = carve_floats(c, energy.scratch_floats);
    s->radial_scratch = carve_floats(c, pliant_radial_floats(asset));
}

/* Bytes from an aligned start. */
static uint64_t measure(const pliant_asset* asset)
{
    carver c = { NULL, 0 };
    carve(&c, sizeof(pliant_solver));
    lay_out(&c, asset, NULL);
    return c.used;
}

size_t pliant_solver_memory(const pliant_asset* asset, const pliant_solver_desc* desc)
{
    if (!is_valid(asset, desc)) return 0;
    const uint64_t size = measure(asset) + (ALIGNMENT - 1); /* wherever the caller's memory starts */
    return size <= SIZE_MAX ? (size_t)size : 0;
}

pliant_result pliant_solver_init(pliant_solver** out, const pliant_asset* asset, const pliant_solver_desc* desc,
                                 void* memory, size_t memory_size)
{
    if (!out) return PLIANT_ERROR_ARGUMENT;
    *out = NULL;
    const size_t needed = pliant_solver_memory(asset, desc);
    if (needed == 0 || !memory) return PLIANT_ERROR_ARGUMENT;
    if (memory_size < needed) return PLIANT_ERROR_MEMORY_SIZE;

    const size_t skip = (size_t)(0u - (uintptr_t)memory) & (ALIGNMENT - 1);
    carver c = { (unsigned char*)memory + skip, 0 };
    memset(c.base, 0, (size_t)measure(asset));
    pliant_solver* solver = (pliant_solver*)carve(&c, sizeof(pliant_solver));
    lay_out(&c, asset, solver);
    solver->magic = SOLVER_MAGIC;
    solver->desc = *desc;
    solver->asset = *asset;
    solver->kernels = asset->kernels;
    *out = solver;
    return PLIANT_OK;
}

void pliant_solver_reset(pliant_solver* solver)
{
    if (!solver || solver->magic != SOLVER_MAGIC) return;
    solver->has_history = 0; /* guards all that a frame reads of earlier ones, but for `combined`, which has no past */
}

/* ------------------------------------------------------------------------------------------------------ weights ---- */

static pliant_result check_weights(const pliant_asset* asset, const float* weights)
{
    const uint32_t count = asset->weight_count;
    float largest = 0.0f;
    for (uint32_t k = 0; k < count; ++k)
        if (!pliant_is_finite(weights[k])) return PLIANT_ERROR_WEIGHT_NOT_FINITE;
    if (asset->has_layers) return PLIANT_OK;
    for (uint32_t k = 0; k < count; ++k) {
        if (weights[k] < 0.0f) return PLIANT_ERROR_WEIGHT_NEGATIVE;
        if (weights[k] > largest) largest = weights[k];
    }
    return largest > 0.0f ? PLIANT_OK : PLIANT_ERROR_WEIGHT_SUM;
}

/* By the largest first: no sum of weights near the ends of the range can overflow or vanish. */
static void normalise_weights(const float* weights, uint32_t count, float* normalised)
{
    float largest = 0.0f, sum = 0.0f;
    for (uint32_t k = 0; k < count; ++k) largest = weights[k] > largest ? weights[k] : largest;
    for (uint32_t k = 0; k < count; ++k) {
        normalised[k] = weights[k] / largest;
        sum += normalised[k];
    }
    for (uint32_t k = 0; k < count; ++k) normalised[k] /= sum;
}

/* How far weights of layers lie outside their ranges, in widths of these: the worst. In double precision no difference
   overflows. */
static float measure_outside(const pliant_asset* asset, const float* weights)
{
    double worst = 0.0;
    for (uint32_t k = 0; asset->layers && k + 1 < asset->pose_count; ++k) {
        const double low = (double)asset->layers[k].low, high = (double)asset->layers[k].high, v = (double)weights[k];
        const double beyond = (v > high ? v - high : low - v) / (high - low);
        if (beyond > worst) worst = beyond;
    }
    return worst < (double)FLT_MAX ? (float)worst : FLT_MAX;
}

/* Makes solver->weights: normalised, or (1, v) of layers. */
static void set_weights(pliant_solver* solver, const float* weights)
{
    const pliant_asset* asset = &solver->asset;
    solver->outside = measure_outside(asset, weights);
    if (!asset->has_layers) {
        normalise_weights(weights, asset->pose_count, solver->weights);
        return;
    }
    solver->weights[0] = 1.0f;
    memcpy(solver->weights + 1, weights, (asset->pose_count - 1) * sizeof *weights);
}

/* The sum of the changes; of layers, any number of which may move at the same time, the largest. */
static float distance_of_weights(const pliant_asset* asset, const float* a, const float* b)
{
    float sum = 0.0f, largest = 0.0f;
    for (uint32_t k = 0; k < asset->pose_count; ++k) {
        const float change = fabsf(a[k] - b[k]);
        sum += change;
        if (change > largest) largest = change;
    }
    return asset->has_layers ? largest : sum;
}

/* -------------------------------------------------------------------------------------------------------- start ---- */

/* Makes the point `z` the current one if it can be evaluated. */
static int try_start(pliant_solver* solver, const float* z)
{
    double energy;
    if (!pliant_solver_evaluate(solver, z, &energy, solver->trial_gradient)) return 0;
    const size_t size = solver->asset.padded_dimension * sizeof(float);
    memcpy(solver->z, z, size);
    memcpy(solver->gradient, solver->trial_gradient, size);
    solver->energy = energy;
    return 1;
}

static int may_evaluate(const pliant_solver* solver) { return solver->evaluations < solver->evaluation_limit; }

/* Where a frame begins. NONE: not even z = 0 can be evaluated, or not any more. */
typedef enum start { START_NONE, START_LAST, START_PREDICTOR, START_ZERO } start;

static start start_from_zero(pliant_solver* solver)
{
    if (!may_evaluate(solver)) return START_NONE;
    memset(solver->trial, 0, solver->asset.padded_dimension * sizeof(float));
    return try_start(solver, solver->trial) ? START_ZERO : START_NONE;
}

/* From z0(w), with a fresh matrix. */
static start start_afresh(pliant_solver* solver)
{
    pliant_bfgs_forget(solver);
    if (!solver->asset.predictor_centres) return start_from_zero(solver);
    const int has_start = may_evaluate(solver) && try_start(solver, solver->start);
    /* The energy at z = 0 is 0 by definition: a predictor that ends above it is worse than the equal-weight average, or than
       the rest shape of layers, and is what was asked for only if nothing is to be minimised. */
    if (has_start && (solver->energy <= 0.0 || solver->desc.max_iterations == 0)) return START_PREDICTOR;
    const start zero = start_from_zero(solver);
    return zero == START_NONE && has_start ? START_PREDICTOR : zero;
}

/* From the last frame, moved as the predictor moves: what the predictor is off by changes less than the blend does. The
   matrix is kept. */
static int start_from_last(pliant_solver* solver)
{
    for (size_t j = 0; j < solver->asset.padded_dimension; ++j)
        solver->trial[j] = solver->previous_z[j] + (solver->start[j] - solver->previous_start[j]);
    return try_start(solver, solver->trial) || (may_evaluate(solver) && try_start(solver, solver->previous_z));
}

/* Near the last frame in weights, with something to minimise: without, the predictor is the answer. */
static int may_continue(const pliant_solver* solver)
{
    const pliant_solver_desc* desc = &solver->desc;
    if (!solver->has_history || desc->max_iterations == 0 || !(desc->continuity > 0.0f)) return 0;
    return distance_of_weights(&solver->asset, solver->weights, solver->previous_weights) <= desc->continuity;
}

/* Also makes the load, which every start needs. */
static start choose_start(pliant_solver* solver)
{
    pliant_radial_evaluate(solver->kernels, &solver->asset, solver->weights, solver->radial_scratch, solver->start,
                           solver->load);
    return may_continue(solver) && start_from_last(solver) ? START_LAST : start_afresh(solver);
}

/* -------------------------------------------------------------------------------------------------------- frame ---- */

/* q = mean + S z; 0 if an asset's absurd numbers make it overflow. */
static int write_coordinates(const pliant_solver* solver, float* q)
{
    const pliant_asset* asset = &solver->asset;
    const size_t d = asset->padded_dimension;
    float* sum = solver->product;
    solver->kernels->combine_columns(sum, asset->whitening, solver->z, asset->dimension, d);
    for (size_t j = 0; j < d; ++j) sum[j] += asset->mean[j];
    for (size_t j = 0; j < asset->dimension; ++j)
        if (!pliant_is_finite(sum[j])) return 0;
    memcpy(q, sum, asset->dimension * sizeof *q);
    return 1;
}

static void remember(pliant_solver* solver, pliant_status status)
{
    const size_t z_size = solver->asset.padded_dimension * sizeof(float);
    memcpy(solver->previous_z, solver->z, z_size);
    memcpy(solver->previous_start, solver->start, z_size);
    memcpy(solver->previous_weights, solver->weights, solver->asset.pose_count * sizeof(float));
    solver->has_history = 1;
    solver->is_settled = status == PLIANT_STATUS_CONVERGED;
}

/* Whether the last frame's answer is this one's: the weights are the same to the bit. */
static int is_answered(const pliant_solver* solver)
{
    return solver->has_history && solver->is_settled
        && memcmp(solver->weights, solver->previous_weights, solver->asset.pose_count * sizeof(float)) == 0;
}

static void describe(pliant_solver* solver, pliant_status status, pliant_solve_info* info)
{
    if (!info) return;
    info->status = status;
    info->iterations = solver->iterations;
    info->evaluations = solver->evaluations;
    info->energy = (float)solver->energy;
    info->gradient = sqrtf(fabsf(pliant_bfgs_direction(solver)) / solver->asset.energy_scale);
    if (!pliant_is_finite(info->gradient)) info->gradient = FLT_MAX;
    info->outside = solver->outside;
}

/* An asset whose numbers cannot be evaluated anywhere that we looked: the equal-weight average, or the rest shape
   of layers, is all there is. */
static void give_up(pliant_solver* solver, float* q, pliant_solve_info* info)
{
    memcpy(q, solver->asset.mean, solver->asset.dimension * sizeof *q);
    solver->has_history = 0;
    if (!info) return;
    info->status = PLIANT_STATUS_STALLED;
    info->iterations = solver->iterations;
    info->evaluations = solver->evaluations;
    info->energy = 0.0f;
    info->gradient = FLT_MAX;
    info->outside = solver->outside;
}

/* Whether a descent ended where there was still something to gain but no way to it. One that made all its iterations was
   on its way, and the next frame goes on from there. */
static int is_stuck(pliant_solver* solver, pliant_status status)
{
    if (status == PLIANT_STATUS_CONVERGED || solver->iterations >= solver->desc.max_iterations) return 0;
    const double expected_decrease = 0.5 * (double)pliant_bfgs_direction(solver);
    return !(expected_decrease <= PLIANT_ENERGY_NOISE * (double)solver->asset.energy_scale);
}

/* The descent from the predictor; if it gets stuck another one from z = 0 within the same limits, and the lower end. */
static pliant_status minimise_jump(pliant_solver* solver)
{
    const size_t size = solver->asset.padded_dimension * sizeof(float);
    const uint32_t reserve = solver->desc.max_evaluations / SECOND_DESCENT_SHARE;
    if (reserve < SECOND_DESCENT_LEAST) return pliant_bfgs_minimise(solver);
    solver->evaluation_limit -= reserve;
    const pliant_status first_status = pliant_bfgs_minimise(solver);
    solver->evaluation_limit += reserve;
    if (!is_stuck(solver, first_status)) return first_status;

    float* first_gradient = solver->previous_z; /* a jump has no use for the last frame */
    const double first_energy = solver->energy;
    memcpy(solver->first_z, solver->z, size);
    memcpy(first_gradient, solver->gradient, size);
    pliant_bfgs_forget(solver);
    if (start_from_zero(solver) == START_ZERO) {
        const pliant_status status = pliant_bfgs_minimise(solver);
        if (solver->energy < first_energy) return status;
    }
    memcpy(solver->z, solver->first_z, size);
    memcpy(solver->gradient, first_gradient, size);
    solver->energy = first_energy;
    pliant_bfgs_forget(solver); /* what it learned belongs to another place */
    return first_status;
}

pliant_result pliant_solve(pliant_solver* solver, const float* weights, float* q, pliant_solve_info* info)
{
    if (!solver || solver->magic != SOLVER_MAGIC || !weights || !q) return PLIANT_ERROR_ARGUMENT;
    const pliant_result result = check_weights(&solver->asset, weights);
    if (result != PLIANT_OK) return result;

    set_weights(solver, weights);
    solver->iterations = 0;
    solver->evaluations = 0;
    solver->evaluation_limit = solver->desc.max_evaluations;
    pliant_status status = PLIANT_STATUS_CONVERGED;
    if (!is_answered(solver)) {
        pliant_solver_combine(solver);
        const start begun = choose_start(solver);
        if (begun == START_NONE) {
            give_up(solver, q, info);
            return PLIANT_OK;
        }
        status = begun == START_PREDICTOR ? minimise_jump(solver) : pliant_bfgs_minimise(solver);
    }
    if (!write_coordinates(solver, q)) {
        give_up(solver, q, info);
        return PLIANT_OK;
    }
    describe(solver, status, info);
    remember(solver, status);
    return PLIANT_OK;
}
