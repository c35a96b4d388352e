/* Caps and absurd numbers: iterations and evaluations are bounded, every status comes with a finite q that is not worse than
   the start, whatever finite numbers an asset holds. */
#include "../../formats/pliant_format.h"
#include "support.h"

#include <float.h>
#include <math.h>

static void check_caps(const opened* o)
{
    float weights[64], q[256];
    for (uint32_t cap = 0; cap <= 6; ++cap) {
        pliant_solver_desc desc = pliant_solver_desc_default();
        desc.tolerance = 1e-6f; /* never reached: the caps decide */
        desc.max_iterations = cap;
        const made_solver made = make_solver(&o->asset, &desc);
        uint64_t state = 31;
        for (int frame = 0; frame < 20; ++frame) {
            pliant_solve_info info;
            random_blend(&state, &o->asset, weights);
            CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s", o->name);
            CHECK(info.iterations <= cap && info.evaluations <= desc.max_evaluations, "%s: %u iterations, %u evaluations",
                  o->name, info.iterations, info.evaluations);
            if (cap <= 1) CHECK(info.status != PLIANT_STATUS_CONVERGED || info.gradient <= 1e-6f, "%s: status", o->name);
        }
        free(made.memory);
    }
    for (uint32_t cap = 1; cap <= 6; ++cap) {
        pliant_solver_desc desc = pliant_solver_desc_default();
        desc.max_evaluations = cap;
        const made_solver made = make_solver(&o->asset, &desc);
        pliant_solve_info info;
        uint64_t state = 37;
        random_blend(&state, &o->asset, weights);
        CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s", o->name);
        CHECK(info.evaluations <= cap, "%s: %u evaluations, %u allowed", o->name, info.evaluations, cap);
        free(made.memory);
    }
}

/* More iterations never end higher; the start itself is the answer without iterations. */
static void check_descent(const opened* o)
{
    const float noise = 4e-5f * o->asset.energy_scale;
    float weights[64], q[256];
    uint64_t state = 41;
    for (int round = 0; round < 10; ++round) {
        float start = 0.0f;
        random_blend(&state, &o->asset, weights);
        for (uint32_t cap = 0; cap <= 30; cap += SLOWNESS > 1 ? 10 : 3) {
            pliant_solver_desc desc = pliant_solver_desc_default();
            desc.max_iterations = cap;
            const made_solver made = make_solver(&o->asset, &desc);
            pliant_solve_info info;
            CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s", o->name);
            if (cap == 0) start = info.energy;
            CHECK(info.energy <= start + noise, "%s: %u iterations end at %.9g, the start was %.9g", o->name, cap,
                  (double)info.energy, (double)start);
            free(made.memory);
        }
    }
}

/* Where in the blob a float of a chunk lies; 0 if the asset has none. */
static size_t random_place(const opened* o, uint32_t tag, uint64_t* state)
{
    size_t size;
    const unsigned char* chunk = pliant_asset_chunk(&o->asset, tag, &size);
    if (!chunk) return 0;
    const size_t start = (size_t)(chunk - o->blob.data);
    if (tag == PLIANT_CHUNK_LOAD) { /* its padding must be zero */
        const uint32_t rows = o->asset.predictor_count + o->asset.pose_count;
        const size_t row = random_below(state, rows), column = random_below(state, o->asset.dimension);
        return start + 64 + 4 * (row * o->asset.padded_dimension + column);
    }
    /* Behind the records of ELEM at the latest, or the whole chunk's middle. */
    const size_t skip = size > 1024 ? 512 : 64;
    return start + skip + 4 * (size_t)random_below(state, (uint32_t)((size - skip) / 4));
}

/* Replaces floats of SOLV, ELEM, PRED and LOAD by extreme ones; the asset still opens, as they are finite. */
static void check_absurd_numbers(const opened* o)
{
    static const float extreme[] = { 0.0f, -1.0f, 1e-38f, -1e-38f, 1e20f, -1e20f, FLT_MAX, -FLT_MAX, 1e-45f, 1e6f };
    static const uint32_t tags[] = { PLIANT_CHUNK_SOLVER, PLIANT_CHUNK_ELEMENTS, PLIANT_CHUNK_PREDICTOR, PLIANT_CHUNK_LOAD };
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const int rounds = (strstr(o->name, "arap") || strstr(o->name, "mixed") ? 100 : 400) / SLOWNESS;
    uint64_t state = 43;
    int opened_count = 0;
    for (int round = 0; round < rounds; ++round) {
        blob_file blob = make_blob(o->blob.data, o->blob.size);
        pliant_asset asset;
        const uint32_t changes = 1 + random_below(&state, 30);
        for (uint32_t i = 0; i < changes; ++i) {
            const float value = extreme[random_below(&state, 10)];
            const size_t at = random_place(o, tags[random_below(&state, 4)], &state);
            if (at) memcpy(blob.data + at, &value, sizeof value);
        }
        if (pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_DEFAULT) == PLIANT_OK) {
            const made_solver made = make_solver(&asset, &desc);
            float weights[64], q[256];
            ++opened_count;
            for (int frame = 0; frame < 3; ++frame) {
                pliant_solve_info info;
                random_blend(&state, &asset, weights);
                CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s", o->name);
                CHECK(info.evaluations <= desc.max_evaluations, "%s: %u evaluations", o->name, info.evaluations);
                for (uint32_t j = 0; j < asset.dimension; ++j)
                    CHECK(q[j] - q[j] == 0.0f, "%s: round %d: q is not finite", o->name, round);
                CHECK(info.gradient - info.gradient == 0.0f && info.energy - info.energy == 0.0f, "%s: info", o->name);
            }
            free(made.memory);
        }
        free_blob(blob);
    }
    /* In small files half of all bytes are such as open looks at. */
    CHECK(opened_count > rounds / 4, "%s: only %d of %d opened: this tests nothing", o->name, opened_count, rounds);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_caps);
    for_each_asset(argv[1], check_descent);
    for_each_asset(argv[1], check_absurd_numbers);
    return report("limits");
}
