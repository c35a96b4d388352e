/* Where a jump starts and ends: no higher than its predictor, no higher than the equal-weight average, and if the descent
   from the predictor gets stuck no higher than a second one from z = 0 with the evaluations left. And that a frame of the
   same weights costs nothing once it has converged, and goes on if it has not. Argument: the folder of
   make_test_assets.py. */
#include "../../formats/pliant_format.h"
#include "support.h"

#include <math.h>

enum { EVALUATIONS = 40, SHARE = 30 }; /* of the first descent; below 32 a frame has no second */

static int cold_won, predictor_won, converged, unconverged;

/* One frame of a new solver. */
static pliant_solve_info jump(const pliant_asset* asset, uint32_t iterations, uint32_t evaluations, const float* weights)
{
    float q[PLIANT_FORMAT_MAX_DIMENSION];
    pliant_solve_info info = { PLIANT_STATUS_LIMIT, 0, 0, 0.0f, 0.0f, 0.0f };
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.max_iterations = iterations;
    desc.max_evaluations = evaluations;
    const made_solver made = make_solver(asset, &desc);
    CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "a jump");
    free(made.memory);
    return info;
}

/* Mostly near corners and edges, where predictors are worst. */
static void corner_heavy_weights(uint64_t* state, uint32_t count, float* weights)
{
    for (uint32_t k = 0; k < count; ++k) {
        const float u = random_unit(state) + 1e-6f;
        weights[k] = u * u * u * u;
    }
}

static void check_bounds(const opened* o, const float* weights)
{
    const double noise = 2e-5 * (double)o->asset.energy_scale + 1e-6; /* energies are reported as floats */
    const pliant_solve_info start = jump(&o->asset, 0, 2, weights);
    for (uint32_t iterations = 1; iterations <= 64; iterations *= 4) {
        const pliant_solve_info end = jump(&o->asset, iterations, 120, weights);
        CHECK((double)end.energy <= noise, "%s: %u iterations end above z = 0 by %.3g", o->name, iterations,
              (double)end.energy);
        CHECK((double)end.energy <= (double)start.energy + noise, "%s: %u iterations end above the predictor by %.3g",
              o->name, iterations, (double)(end.energy - start.energy));
    }
}

/* The first descent alone is what a solver with its share does, the second what one without a predictor does with
   the rest. */
static void check_second_descent(const opened* o, const float* weights)
{
    const float scale = o->asset.energy_scale;
    const pliant_solve_info first = jump(&o->asset, 60, SHARE, weights);
    const pliant_solve_info both = jump(&o->asset, 60, EVALUATIONS, weights);
    const int is_stuck = first.status != PLIANT_STATUS_CONVERGED && 0.5f * first.gradient * first.gradient > 2e-5f;
    CHECK(both.evaluations <= EVALUATIONS && both.iterations <= 60, "%s: over a limit", o->name);
    /* From z = 0 in the first place: there is no second. */
    if (!o->asset.predictor_centres || jump(&o->asset, 0, 2, weights).energy > 0.0f) return;
    if (!is_stuck) {
        CHECK(memcmp(&first, &both, sizeof first) == 0, "%s: a second descent without need", o->name);
        return;
    }
    if (o->asset.load_coefficients) return; /* it needs the centres that the next line takes away */
    pliant_asset cold = o->asset;
    cold.predictor_centres = NULL;
    const pliant_solve_info second = jump(&cold, 60 - first.iterations, EVALUATIONS - first.evaluations, weights);
    const float lower = second.energy < first.energy ? second.energy : first.energy;
    cold_won += second.energy < first.energy;
    predictor_won += second.energy >= first.energy;
    CHECK(both.energy == lower, "%s: ends at %.9g, its two descents at %.9g and %.9g (scale %.3g)", o->name,
          (double)both.energy, (double)first.energy, (double)second.energy, (double)scale);
    CHECK(both.status == (second.energy < first.energy ? second.status : first.status), "%s: status", o->name);
    CHECK(both.iterations == first.iterations + second.iterations
              && both.evaluations == first.evaluations + second.evaluations,
          "%s: %u iterations and %u evaluations instead of %u + %u and %u + %u", o->name, both.iterations, both.evaluations,
          first.iterations, second.iterations, first.evaluations, second.evaluations);
}

/* Frames of the same weights, each of so many iterations. */
static void check_repeated(const opened* o, const float* weights, uint32_t iterations)
{
    float q[2][PLIANT_FORMAT_MAX_DIMENSION];
    pliant_solve_info info[2]
        = { { PLIANT_STATUS_LIMIT, 0, 0, 0.0f, 0.0f, 0.0f }, { PLIANT_STATUS_LIMIT, 0, 0, 0.0f, 0.0f, 0.0f } };
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.max_iterations = iterations;
    const made_solver made = make_solver(&o->asset, &desc);
    for (int frame = 0; frame < 2; ++frame)
        CHECK(pliant_solve(made.solver, weights, q[frame], &info[frame]) == PLIANT_OK, "%s", o->name);
    if (info[0].status == PLIANT_STATUS_CONVERGED) {
        CHECK(info[1].evaluations == 0 && info[1].iterations == 0, "%s: %u evaluations for the same weights", o->name,
              info[1].evaluations);
        CHECK(info[1].status == info[0].status && info[1].energy == info[0].energy && info[1].gradient == info[0].gradient
                  && memcmp(q[0], q[1], o->asset.dimension * sizeof(float)) == 0,
              "%s: another answer for the same weights", o->name);
    } else
        CHECK(info[1].evaluations > 0, "%s: a frame that has not converged does not go on", o->name);
    converged += info[0].status == PLIANT_STATUS_CONVERGED;
    unconverged += info[0].status != PLIANT_STATUS_CONVERGED;
    free(made.memory);
}

static void check_asset(const opened* o)
{
    const int rounds = (strstr(o->name, "arap") || strstr(o->name, "mixed") ? 30 : 400) / SLOWNESS;
    float weights[PLIANT_FORMAT_MAX_POSES];
    uint64_t state = 59;
    for (int round = 0; round < rounds; ++round) {
        corner_heavy_weights(&state, o->asset.weight_count, weights);
        for (uint32_t k = 3; o->asset.has_layers && k < o->asset.weight_count; ++k) weights[k] *= 0.1f;
        check_bounds(o, weights);
        check_second_descent(o, weights);
        check_repeated(o, weights, round % 2 ? 60 : 1);
    }
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_asset);
    printf("%d second descents won, %d lost\n", cold_won, predictor_won);
    CHECK(cold_won > 0 && predictor_won > 0, "not both outcomes occur: half of this tests nothing");
    CHECK(converged > 0 && unconverged > 0, "%d frames converged, %d did not", converged, unconverged);
    return report("start");
}
