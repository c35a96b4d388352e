/* One character's solver: carving its memory, judging weights, choosing where a frame starts, turning z into q. The
   minimisation itself is in bfgs.c. */
#include "internal.h"
#include "linalg.h"

#include <float.h>
#include <math.h>

#define SOLVER_MAGIC 0x504C5356u /* "PLSV": memory that no pliant_solver_init made is refused */

/* Vectors and matrices start at multiples of this: a cache line, and what the widest vectors like. */
#define ALIGNMENT 64u

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
    const pliant_elements_layout elements = pliant_elements_measure(asset);
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
    s->inverse_hessian = carve_floats(c, d * d);
    s->combined = carve_floats(c, elements.combined_floats);
    s->scratch = carve_floats(c, elements.scratch_floats);
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
    *out = solver;
    return PLIANT_OK;
}

void pliant_solver_reset(pliant_solver* solver)
{
    if (!solver || solver->magic != SOLVER_MAGIC) return;
    solver->history = 0; /* all that a frame reads of earlier ones is guarded by it */
}

/* ------------------------------------------------------------------------------------------------------ weights ---- */

static pliant_result judge_weights(const float* weights, uint32_t count)
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

int pliant_solver_evaluate(pliant_solver* solver, const float* z, double* energy, float* gradient)
{
    ++solver->evaluations;
    *energy = pliant_elements_evaluate(&solver->asset, solver->weights, solver->combined, z, gradient, solver->scratch);
    /* A sum of squares in single precision overflows before anything computed from this point can. */
    const float square = pliant_dot(gradient, gradient, solver->asset.padded_dimension);
    return fabs(*energy) <= (double)FLT_MAX && pliant_is_finite(square);
}

/* z0(w), formats/SPEC.md section 4, PRED; 0 for an asset without one. */
static void predict(const pliant_solver* solver, float* z)
{
    const pliant_asset* asset = &solver->asset;
    const size_t d = asset->padded_dimension, m = asset->pose_count;
    memset(z, 0, d * sizeof *z);
    if (!asset->predictor_centres) return;
    const float* coefficients = asset->predictor_coefficients;
    for (uint32_t i = 0; i < asset->predictor_count; ++i, coefficients += d) {
        const float* centre = asset->predictor_centres + i * m;
        float square = 0.0f;
        for (size_t k = 0; k < m; ++k) square += (solver->weights[k] - centre[k]) * (solver->weights[k] - centre[k]);
        pliant_add_scaled(z, square * sqrtf(square), coefficients, d);
    }
    for (size_t k = 0; k < m; ++k, coefficients += d) pliant_add_scaled(z, solver->weights[k], coefficients, d);
    for (size_t j = asset->dimension; j < d; ++j) z[j] = 0.0f; /* a file's padding must not enter sums */
}

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

static int may_evaluate(const pliant_solver* solver) { return solver->evaluations < solver->desc.max_evaluations; }

/* From the predictor, with a fresh matrix. 0 if not even z = 0 can be evaluated, or not any more. */
static int start_afresh(pliant_solver* solver)
{
    const size_t d = solver->asset.padded_dimension;
    pliant_bfgs_forget(solver);
    predict(solver, solver->trial);
    /* The energy at z = 0 is 0 by definition: a predictor that ends above it is worse than the equal-weight average. */
    const int has_start = may_evaluate(solver) && try_start(solver, solver->trial);
    if (has_start && solver->energy <= 0.0) return 1;
    if (!may_evaluate(solver)) return has_start;
    memset(solver->trial, 0, d * sizeof(float));
    return try_start(solver, solver->trial);
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

/* -------------------------------------------------------------------------------------------------------- frame ---- */

/* q = mean + S z; 0 if an asset's absurd numbers make it overflow. */
static int write_coordinates(const pliant_solver* solver, float* q)
{
    const pliant_asset* asset = &solver->asset;
    const size_t d = asset->padded_dimension;
    float* sum = solver->product;
    pliant_combine_columns(sum, asset->whitening, solver->z, asset->dimension, d);
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

pliant_result pliant_solve(pliant_solver* solver, const float* weights, float* q, pliant_solve_info* info)
{
    if (!solver || solver->magic != SOLVER_MAGIC || !weights || !q) return PLIANT_ERROR_ARGUMENT;
    const uint32_t m = solver->asset.pose_count;
    const pliant_result result = judge_weights(weights, m);
    if (result != PLIANT_OK) return result;

    normalise_weights(weights, m, solver->weights);
    pliant_elements_combine(&solver->asset, solver->weights, solver->combined);
    solver->iterations = 0;
    solver->evaluations = 0;

    int is_continued = solver->history > 0 && solver->desc.continuity > 0.0f
        && distance_of_weights(solver->weights, solver->previous_weights, m) <= solver->desc.continuity;
    if (is_continued) is_continued = start_from_last(solver);
    if (!is_continued && !start_afresh(solver)) {
        give_up(solver, q, info);
        return PLIANT_OK;
    }
    const pliant_status status = pliant_bfgs_minimise(solver);
    if (!write_coordinates(solver, q)) {
        give_up(solver, q, info);
        return PLIANT_OK;
    }
    describe(solver, status, info);
    remember(solver, is_continued);
    return PLIANT_OK;
}
