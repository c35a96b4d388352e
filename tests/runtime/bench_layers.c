/* Cost of layers: combining the numbers of the surrogate energy, once a frame, and one evaluation, by the number of moving
   layers. Arguments: assets of layers. Measures, asserts nothing. */
#define _POSIX_C_SOURCE 199309L
#include "internal.h"
#include "support.h"

#include <time.h>

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* With so many layers moving: the best of many rounds. */
static void bench(pliant_solver* s, uint32_t moving)
{
    double best_combine = 1.0, best = 1.0, energy;
    memset(s->z, 0, s->asset.padded_dimension * sizeof(float));
    for (int round = 0; round < 3000; ++round) {
        s->weights[0] = 1.0f;
        for (uint32_t k = 1; k < s->asset.pose_count; ++k) s->weights[k] = k <= moving ? 1e-4f * (float)(1 + round) : 0.0f;
        s->is_combined = 0;
        const double t0 = now();
        pliant_solver_combine(s);
        const double t1 = now();
        pliant_solver_evaluate(s, s->z, &energy, s->gradient);
        const double t2 = now();
        if (t1 - t0 < best_combine) best_combine = t1 - t0;
        if (t2 - t1 < best) best = t2 - t1;
    }
    printf("  %u layers move: combine %.2f us, value and gradient %.2f us\n", moving, 1e6 * best_combine, 1e6 * best);
}

int main(int argc, char** argv)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    for (int i = 1; i < argc; ++i) {
        pliant_asset asset;
        const blob_file blob = read_blob(argv[i]);
        if (pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_DEFAULT) != PLIANT_OK || !asset.has_layers) return 2;
        const made_solver made = make_solver(&asset, &desc);
        printf("%s: d %u, %u layers, solver %.1f KiB\n", argv[i], asset.dimension, asset.weight_count,
               (double)made.size / 1024.0);
        for (uint32_t b = 0; b < asset.batch_count; ++b) {
            const pliant_format_batch* batch = (const pliant_format_batch*)asset.batches + b;
            printf("  %u elements of kind %u, %u changes\n", batch->element_count, batch->kind, batch->change_count);
        }
        for (uint32_t moving = 0; moving <= asset.weight_count; moving = moving < 4 ? moving + 1 : 2 * moving)
            bench(made.solver, moving);
        free(made.memory);
        free_blob(blob);
    }
    return 0;
}
