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
    s->earlier_weights = carve_floats(c, m);
    s->z = carve_floats(c, d);
    s->gradient = carve_floats(c, d);
    s->previous_z = carve_floats(c, d);
    s->earlier_z = carve_floats(c, d);
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
    solver->kernels = pliant_kernels_choose();
    *out = solver;
    return PLIANT_OK;
}

void pliant_solver_reset(pliant_solver* solver)
{
    if (!solver || solver->magic != SOLVER_MAGIC) return;
    solver->history = 0; /* all that a frame reads of earlier ones is guarded by it, but for `combined`, which has no past */
}

/* ------------------------------------------------------------------------------------------------------ weights ---- */

static pliant_result check_weights(const float* weights, uint32_t count)
{
    float largest = 0.0f;
    for (uint32_t k = 0; k < count; ++k)
        if (!pliant_is_finite(weights[k])) return PLIANT_ERROR_WEIGHT_NOT_FINITE;
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

static float distance_of_weights(const float* a, const float* b, uint32_t count)
{
    float sum = 0.0f;
    for (uint32_t k = 0; k < count; ++k) sum += fabsf(a[k] - b[k]);
    return sum;
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

/* From z0(w), which solver->trial holds, with a fresh matrix. */
static start start_afresh(pliant_solver* solver)
{
    pliant_bfgs_forget(solver);
    if (!solver->asset.predictor_centres) return start_from_zero(solver);
    const int has_start = may_evaluate(solver) && try_start(solver, solver->trial);
    /* The energy at z = 0 is 0 by definition: a predictor that ends above it is worse than the equal-weight average, and is
       what was asked for only if nothing is to be minimised. */
    if (has_start && (solver->energy <= 0.0 || solver->desc.max_iterations == 0)) return START_PREDICTOR;
    const start zero = start_from_zero(solver);
    return zero == START_NONE && has_start ? START_PREDICTOR : zero;
}

/* How far along the last step of the weights the new one goes, or 0 if there is nothing to continue. */
static float continuation_factor(const pliant_solver* solver)
{
    float along = 0.0f, square = 0.0f;
    if (solver->history < 2) return 0.0f;
    for (uint32_t k = 0; k < solver->asset.pose_count; ++k) {
        const float last = solver->previous_weights[k] - solver->earlier_weights[k];
        along += (solver->weights[k] - solver->previous_weights[k]) * last;
        square += last * last;
    }
    /* A drag that turned round or stands still has no direction to continue; beyond twice the last step a straight line
       says nothing. */
    if (!(along > 0.0f)) return 0.0f;
    return along < 2.0f * square ? along / square : 2.0f;
}

/* From the last frame, or further along the line through the last two if that is lower. The matrix is kept. */
static int start_from_last(pliant_solver* solver)
{
    const size_t d = solver->asset.padded_dimension;
    if (!try_start(solver, solver->previous_z)) return 0;
    const float factor = continuation_factor(solver);
    if (factor == 0.0f || !may_evaluate(solver)) return 1;
    for (size_t j = 0; j < d; ++j)
        solver->trial[j] = solver->previous_z[j] + factor * (solver->previous_z[j] - solver->earlier_z[j]);
    double energy;
    if (pliant_solver_evaluate(solver, solver->trial, &energy, solver->trial_gradient) && energy < solver->energy) {
        memcpy(solver->z, solver->trial, d * sizeof(float));
        memcpy(solver->gradient, solver->trial_gradient, d * sizeof(float));
        solver->energy = energy;
    }
    return 1;
}

/* Near the last frame in weights, with something to minimise: without, the predictor is the answer. */
static int may_continue(const pliant_solver* solver)
{
    const pliant_solver_desc* desc = &solver->desc;
    if (solver->history == 0 || desc->max_iterations == 0 || !(desc->continuity > 0.0f)) return 0;
    return distance_of_weights(solver->weights, solver->previous_weights, solver->asset.pose_count) <= desc->continuity;
}

/* Also makes the load, which every start needs. */
static start choose_start(pliant_solver* solver)
{
    const int is_near = may_continue(solver);
    pliant_radial_evaluate(&solver->asset, solver->weights, is_near ? NULL : solver->trial, solver->load);
    if (is_near) {
        if (start_from_last(solver)) return START_LAST;
        pliant_radial_evaluate(&solver->asset, solver->weights, solver->trial, NULL);
    }
    return start_afresh(solver);
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

static void remember(pliant_solver* solver, int was_continued)
{
    const size_t z_size = solver->asset.padded_dimension * sizeof(float);
    const size_t w_size = solver->asset.pose_count * sizeof(float);
    memcpy(solver->earlier_z, solver->previous_z, z_size);
    memcpy(solver->earlier_weights, solver->previous_weights, w_size);
    memcpy(solver->previous_z, solver->z, z_size);
    memcpy(solver->previous_weights, solver->weights, w_size);
    solver->history = was_continued ? 2 : 1;
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
}

/* An asset whose numbers cannot be evaluated anywhere that we looked: the equal-weight average is all there is. */
static void give_up(pliant_solver* solver, float* q, pliant_solve_info* info)
{
    memcpy(q, solver->asset.mean, solver->asset.dimension * sizeof *q);
    solver->history = 0;
    if (!info) return;
    info->status = PLIANT_STATUS_STALLED;
    info->iterations = solver->iterations;
    info->evaluations = solver->evaluations;
    info->energy = 0.0f;
    info->gradient = FLT_MAX;
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

    /* A jump has no use for the last frames: their places keep the first end. */
    float* first_z = solver->earlier_z;
    float* first_gradient = solver->previous_z;
    const double first_energy = solver->energy;
    memcpy(first_z, solver->z, size);
    memcpy(first_gradient, solver->gradient, size);
    pliant_bfgs_forget(solver);
    if (start_from_zero(solver) == START_ZERO) {
        const pliant_status status = pliant_bfgs_minimise(solver);
        if (solver->energy < first_energy) return status;
    }
    memcpy(solver->z, first_z, size);
    memcpy(solver->gradient, first_gradient, size);
    solver->energy = first_energy;
    pliant_bfgs_forget(solver); /* what it learned belongs to another place */
    return first_status;
}

pliant_result pliant_solve(pliant_solver* solver, const float* weights, float* q, pliant_solve_info* info)
{
    if (!solver || solver->magic != SOLVER_MAGIC || !weights || !q) return PLIANT_ERROR_ARGUMENT;
    const uint32_t m = solver->asset.pose_count;
    const pliant_result result = check_weights(weights, m);
    if (result != PLIANT_OK) return result;

    normalise_weights(weights, m, solver->weights);
    pliant_solver_combine(solver);
    solver->iterations = 0;
    solver->evaluations = 0;
    solver->evaluation_limit = solver->desc.max_evaluations;

    const start begun = choose_start(solver);
    if (begun == START_NONE) {
        give_up(solver, q, info);
        return PLIANT_OK;
    }
    const pliant_status status = begun == START_PREDICTOR ? minimise_jump(solver) : pliant_bfgs_minimise(solver);
    if (!write_coordinates(solver, q)) {
        give_up(solver, q, info);
        return PLIANT_OK;
    }
    describe(solver, status, info);
    remember(solver, begun == START_LAST);
    return PLIANT_OK;
}
