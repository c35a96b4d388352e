/* Weights of averages of any kind: bad ones get their code and change nothing, extreme ones blend, and the frame after
   converges as from a new solver. */
#include "support.h"

#include <math.h>

typedef struct bad_weights {
    const char* what;
    float w[3];
    pliant_result result;
} bad_weights;

static const bad_weights bad[] = {
    { "not a number", { NAN, 0.5f, 0.5f }, PLIANT_ERROR_WEIGHT_NOT_FINITE },
    { "infinite", { INFINITY, 0.0f, 1.0f }, PLIANT_ERROR_WEIGHT_NOT_FINITE },
    { "minus infinite", { 0.0f, -INFINITY, 1.0f }, PLIANT_ERROR_WEIGHT_NOT_FINITE },
    { "all zero", { 0.0f, 0.0f, 0.0f }, PLIANT_ERROR_WEIGHT_SUM },
    { "minus zero", { -0.0f, -0.0f, -0.0f }, PLIANT_ERROR_WEIGHT_SUM },
    { "first negative", { -1.0f, 1.0f, 1.0f }, PLIANT_ERROR_WEIGHT_NEGATIVE },
    { "second negative", { 1.5f, -0.5f, 0.0f }, PLIANT_ERROR_WEIGHT_NEGATIVE },
    { "sum zero", { 1.0f, -1.0f, 0.0f }, PLIANT_ERROR_WEIGHT_NEGATIVE },
    { "sum one", { 3.0f, -1.0f, -1.0f }, PLIANT_ERROR_WEIGHT_NEGATIVE },
};

static const struct {
    float extreme[3], plain[3];
} extremes[] = {
    { { 1e30f, 1e30f, 0.0f }, { 1.0f, 1.0f, 0.0f } },   { { 1e-30f, 1e-30f, 0.0f }, { 1.0f, 1.0f, 0.0f } },
    { { 1e-42f, 1e-42f, 0.0f }, { 1.0f, 1.0f, 0.0f } }, { { 3.4e38f, 3.4e38f, 3.4e38f }, { 1.0f, 1.0f, 1.0f } },
    { { 1e-45f, 0.0f, 1e-45f }, { 1.0f, 0.0f, 1.0f } }, { { 3.4e38f, 1e-45f, 0.0f }, { 1.0f, 0.0f, 0.0f } },
};

static double distance(const pliant_asset* asset, const float* a, const float* b)
{
    const float* first = pliant_asset_pose_coordinates(asset, 0);
    const float* second = pliant_asset_pose_coordinates(asset, 1);
    double error = 0.0, size = 0.0;
    for (uint32_t j = 0; j < asset->dimension; ++j) {
        error += (double)((a[j] - b[j]) * (a[j] - b[j]));
        size += (double)((second[j] - first[j]) * (second[j] - first[j]));
    }
    return sqrt(error / size);
}

static void solve_fresh(const pliant_asset* asset, const pliant_solver_desc* desc, const float* weights, float* q)
{
    const made_solver made = make_solver(asset, desc);
    CHECK(pliant_solve(made.solver, weights, q, NULL) == PLIANT_OK, "a new solver");
    free(made.memory);
}

/* Only assets of three poses: the vectors have three entries. */
static void check_bad(const opened* o)
{
    if (o->asset.pose_count != 3 || o->asset.has_layers) return;
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    unsigned char* before = malloc(made.size);
    const float good[3] = { 0.2f, 0.5f, 0.3f }, next[3] = { 0.25f, 0.45f, 0.3f };
    float q[256], fresh[256];
    if (!before) exit(2);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        float untouched[256];
        pliant_solve_info info = { PLIANT_STATUS_LIMIT, 7, 7, 7.0f, 7.0f, 7.0f };
        const pliant_solve_info same = info;
        CHECK(pliant_solve(made.solver, good, q, NULL) == PLIANT_OK, "%s", o->name);
        memcpy(before, made.memory, made.size);
        memcpy(untouched, q, sizeof q);
        const pliant_result result = pliant_solve(made.solver, bad[i].w, q, &info);
        CHECK(result == bad[i].result, "%s: %s: %s", o->name, bad[i].what, pliant_result_text(result));
        CHECK(is_same_memory(before, made.memory, made.size), "%s: %s changed the solver", o->name, bad[i].what);
        CHECK(memcmp(q, untouched, o->asset.dimension * sizeof(float)) == 0, "%s: %s changed q", o->name, bad[i].what);
        CHECK(memcmp(&info, &same, sizeof info) == 0, "%s: %s changed info", o->name, bad[i].what);
        CHECK(pliant_solve(made.solver, next, q, NULL) == PLIANT_OK, "%s", o->name);
        solve_fresh(&o->asset, &desc, next, fresh);
        CHECK(distance(&o->asset, q, fresh) < 2e-3, "%s: after %s off by %.3g", o->name, bad[i].what,
              distance(&o->asset, q, fresh));
    }
    for (size_t i = 0; i < sizeof extremes / sizeof *extremes; ++i) {
        solve_fresh(&o->asset, &desc, extremes[i].extreme, q);
        solve_fresh(&o->asset, &desc, extremes[i].plain, fresh);
        CHECK(memcmp(q, fresh, o->asset.dimension * sizeof(float)) == 0, "%s: extreme weights %zu off by %.3g", o->name, i,
              distance(&o->asset, q, fresh));
    }
    free(before);
    free(made.memory);
}

/* Weights of random magnitude, each from 2^-149 to 2^127, a good frame after each. */
static void check_random_exponents(const opened* o)
{
    const uint32_t m = o->asset.pose_count;
    if (o->asset.has_layers) return; /* test_layers.c */
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    const int rounds = strstr(o->name, "arap") ? 50 : 300;
    float weights[64], good[64], q[256], fresh[256];
    uint64_t state = 17;
    for (uint32_t k = 0; k < m; ++k) good[k] = 1.0f + (float)k;
    solve_fresh(&o->asset, &desc, good, fresh);
    for (int round = 0; round < rounds; ++round) {
        pliant_solve_info info;
        for (uint32_t k = 0; k < m; ++k) {
            const float magnitude = ldexpf(0.5f + random_unit(&state), (int)random_below(&state, 276) - 149);
            weights[k] = random_below(&state, 8) == 0 ? -magnitude : magnitude;
        }
        const pliant_result result = pliant_solve(made.solver, weights, q, &info);
        for (uint32_t k = 0; k < m && result == PLIANT_OK; ++k) CHECK(weights[k] >= 0.0f, "%s: a negative weight", o->name);
        if (result == PLIANT_OK)
            for (uint32_t j = 0; j < o->asset.dimension; ++j) CHECK(q[j] - q[j] == 0.0f, "%s: not finite", o->name);
        CHECK(pliant_solve(made.solver, good, q, &info) == PLIANT_OK, "%s", o->name);
        CHECK(info.status != PLIANT_STATUS_LIMIT, "%s: round %d: iteration limit", o->name, round);
        CHECK(distance(&o->asset, q, fresh) < 5e-3, "%s: round %d off by %.3g", o->name, round,
              distance(&o->asset, q, fresh));
    }
    free(made.memory);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_bad);
    for_each_asset(argv[1], check_random_exponents);
    return report("weights");
}
