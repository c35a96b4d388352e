/* Random jumps: where a blend that starts at the predictor ends, next to one that starts at the equal-weight average.
       pliant_bench_jumps ASSET... [--jumps N] [--tolerance T]
   A line per asset: jumps that ended higher than from the average (by 1e-3 of the energy scale; the predictor led into a
   worse minimum), lower ones, unconverged ones, evaluations, the median time and that which one in twenty exceeds. A third
   of the weights is uniform on the simplex, the others gather at its edges and corners. Of layers, where the rest shape
   takes the place of the average, a third mixes all, a third every second one, a third four of them. Asserts nothing. */
#define _POSIX_C_SOURCE 199309L
#include "layer_weights.h"
#include "timing.h"

#include <math.h>

enum { max_poses = 65, max_dimension = 256 };

/* In parts of the energy scale: single precision leaves about 1e-5, other minima lie 1e-2 and more apart. */
static const double other_minimum = 1e-3;

static void draw_weights(const pliant_asset* asset, float* weights, int jump, uint64_t* state)
{
    static const float powers[3] = { 1, 3, 6 };
    if (asset->has_layers) {
        const float shares[3] = { 1, 0.5f, sparse_share(asset) };
        draw_layers(asset, shares[jump % 3], state, weights);
        return;
    }
    for (uint32_t k = 0; k < asset->weight_count; ++k)
        weights[k] = powf(-logf(random_unit(state) + 1e-6f) + 1e-6f, powers[jump % 3]);
}

static int measure(const char* path, int jumps, float tolerance)
{
    const blob_file blob = read_blob(path);
    pliant_asset asset;
    const pliant_result result = pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_DEFAULT);
    if (result != PLIANT_OK || asset.pose_count > max_poses || asset.dimension > max_dimension) {
        fprintf(stderr, "%s: %s\n", path, result != PLIANT_OK ? pliant_result_text(result) : "too large for this program");
        return 0;
    }
    pliant_solver_desc desc = pliant_solver_desc_default();
    if (tolerance > 0) desc.tolerance = tolerance;
    pliant_asset cold_asset = asset;
    /* A predictor of zeros: a jump then starts at z = 0, with the dead load, which lives on the same centres. */
    float* zeros = calloc(((size_t)asset.predictor_count + asset.pose_count) * asset.padded_dimension, sizeof *zeros);
    if (!zeros) exit(2);
    cold_asset.predictor_coefficients = zeros;
    made_solver warm = make_solver(&asset, &desc), cold = make_solver(&cold_asset, &desc);
    double* times = malloc((size_t)jumps * sizeof *times);
    if (!times) exit(2);
    int higher = 0, lower = 0, unconverged = 0;
    double evaluations = 0;
    uint64_t state = 20261121;
    for (int i = 0; i < jumps; ++i) {
        float weights[max_poses], q[max_dimension];
        pliant_solve_info a, b;
        draw_weights(&asset, weights, i, &state);
        pliant_solver_reset(warm.solver);
        pliant_solver_reset(cold.solver);
        const double start = now();
        pliant_solve(warm.solver, weights, q, &a);
        times[i] = now() - start;
        pliant_solve(cold.solver, weights, q, &b);
        const double difference = ((double)a.energy - (double)b.energy) / (double)asset.energy_scale;
        higher += difference > other_minimum;
        lower += difference < -other_minimum;
        unconverged += a.status != PLIANT_STATUS_CONVERGED;
        evaluations += (double)a.evaluations / jumps;
    }
    const double middle = median(times, jumps);
    printf("%s: d %u, %d jumps: %d end higher than from the average, %d lower, %d unconverged; %.1f evaluations, %.1f us "
           "(p95 %.1f)\n",
           path, asset.dimension, jumps, higher, lower, unconverged, evaluations, middle, times[(size_t)jumps * 19 / 20]);
    free(times);
    free(zeros);
    free(warm.memory);
    free(cold.memory);
    free_blob(blob);
    return 1;
}

int main(int argc, char** argv)
{
    int jumps = 10000, good = 1, assets = 0;
    float tolerance = 0;
    for (int i = 1; i < argc; ++i)
        if (!strcmp(argv[i], "--jumps") && i + 1 < argc)
            jumps = atoi(argv[++i]);
        else if (!strcmp(argv[i], "--tolerance") && i + 1 < argc)
            tolerance = (float)atof(argv[++i]);
        else
            argv[++assets] = argv[i];
    if (!assets || jumps < 1) {
        fprintf(stderr, "usage: %s ASSET... [--jumps N] [--tolerance T]\n", argv[0]);
        return 2;
    }
    for (int i = 1; i <= assets; ++i) good &= measure(argv[i], jumps, tolerance);
    return good ? 0 : 1;
}
