/* Bounding boxes beside the shapes that they hold.
       pliant_bench_bounds ASSET...
   A line per asset, over random blends: by how much a side of the box of pliant_bounds lies outside the shape, in % of the
   diagonal of the shape's own box, on average and at most, and the median time of a box. Asserts nothing. */
#define _POSIX_C_SOURCE 199309L
#include "layer_weights.h"
#include "timing.h"

#include <math.h>

enum { max_poses = 65, max_dimension = 256, blend_count = 1000 };

typedef struct box {
    float lowest[3], highest[3];
} box;

static box box_of(const float* positions, uint32_t vertex_count)
{
    box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for (uint32_t i = 0; i < 3 * vertex_count; ++i) {
        b.lowest[i % 3] = fminf(b.lowest[i % 3], positions[i]);
        b.highest[i % 3] = fmaxf(b.highest[i % 3], positions[i]);
    }
    return b;
}

/* Of layers all at once, of poses uniform on the simplex. */
static void draw_weights(const pliant_asset* asset, uint64_t* state, float* weights)
{
    if (asset->has_layers) {
        draw_layers(asset, 1, state, weights);
        return;
    }
    for (uint32_t k = 0; k < asset->weight_count; ++k) weights[k] = -logf(random_unit(state) + 1e-6f) + 1e-6f;
}

/* Adds the six distances of one blend to `sum`. */
static void add_overshoot(const box* outer, const box* inner, double* sum, double* largest)
{
    double diagonal = 0;
    for (int c = 0; c < 3; ++c) diagonal += pow((double)inner->highest[c] - (double)inner->lowest[c], 2);
    for (int c = 0; c < 3; ++c) {
        const double below = ((double)inner->lowest[c] - (double)outer->lowest[c]) / sqrt(diagonal),
                     above = ((double)outer->highest[c] - (double)inner->highest[c]) / sqrt(diagonal);
        *sum += below + above;
        *largest = fmax(*largest, fmax(below, above));
    }
}

static int measure(const char* path)
{
    const blob_file blob = read_blob(path);
    pliant_asset asset;
    const pliant_result result = pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_DEFAULT);
    if (result != PLIANT_OK || asset.pose_count > max_poses || asset.dimension > max_dimension) {
        fprintf(stderr, "%s: %s\n", path, result != PLIANT_OK ? pliant_result_text(result) : "too large for this program");
        return 0;
    }
    const pliant_solver_desc desc = pliant_solver_desc_default();
    made_solver made = make_solver(&asset, &desc);
    float* positions = malloc(12 * (size_t)asset.vertex_count);
    if (!positions) exit(2);
    double times[blend_count], sum = 0, largest = 0;
    uint64_t state = 20261127;
    for (int i = 0; i < blend_count; ++i) {
        float weights[max_poses], q[max_dimension];
        box outer;
        draw_weights(&asset, &state, weights);
        pliant_solver_reset(made.solver);
        pliant_solve(made.solver, weights, q, NULL);
        const double start = now();
        pliant_bounds(&asset, q, outer.lowest, outer.highest);
        times[i] = now() - start;
        pliant_reconstruct(&asset, q, 0, asset.vertex_count, positions, 12);
        const box inner = box_of(positions, asset.vertex_count);
        add_overshoot(&outer, &inner, &sum, &largest);
    }
    printf("%s: %u vertices, d %u: wider by %.2f %%, at most %.2f %%; %.1f us\n", path, asset.vertex_count, asset.dimension,
           100 * sum / (6 * blend_count), 100 * largest, median(times, blend_count));
    free(positions);
    free(made.memory);
    free_blob(blob);
    return 1;
}

int main(int argc, char** argv)
{
    int good = argc > 1;
    if (!good) fprintf(stderr, "usage: %s ASSET...\n", argv[0]);
    for (int i = 1; i < argc; ++i) good &= measure(argv[i]);
    return good ? 0 : argc > 1 ? 1 : 2;
}
