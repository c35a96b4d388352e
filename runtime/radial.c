/* What an asset knows as a smooth function of the weights: where a frame starts, z0(w), and the dead load c(w). Cubic radial
   basis functions with a linear part, formats/SPEC.md section 4, PRED and LOAD. */
#include "internal.h"

#include <math.h>

uint64_t pliant_radial_floats(const pliant_asset* asset)
{
    return pliant_pad_lanes(asset->predictor_count + (size_t)asset->pose_count);
}

static float cubed_distance(const float* a, const float* b, size_t m)
{
    float square = 0.0f;
    for (size_t k = 0; k < m; ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
    return square * sqrtf(square);
}

/* What each row of the tables counts: the cubes of the distances from the centres, then the weights. Of layers it is their
   change since all weights were 0: the blend is then the rest shape, whatever the rounding of large coefficients. */
static void measure_centres(const pliant_asset* asset, const float* weights, float* factors)
{
    const size_t m = asset->pose_count;
    float* linear = factors + asset->predictor_count;
    memset(linear, 0, m * sizeof *linear);
    linear[0] = 1.0f; /* until the weights replace them, the weights (1, 0) */
    for (uint32_t i = 0; i < asset->predictor_count; ++i) {
        const float* centre = asset->predictor_centres + i * m;
        factors[i] = cubed_distance(weights, centre, m);
        if (asset->has_layers) factors[i] -= cubed_distance(linear, centre, m);
    }
    memcpy(linear, weights, m * sizeof *weights);
    if (asset->has_layers) linear[0] = 0.0f;
}

void pliant_radial_evaluate(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights, float* scratch,
                            float* start, float* load)
{
    const size_t d = asset->padded_dimension, rows = asset->predictor_count + (size_t)asset->pose_count;
    if (!asset->predictor_centres) {
        memset(start, 0, d * sizeof *start);
        return;
    }
    measure_centres(asset, weights, scratch);
    kernels->combine_columns(start, asset->predictor_coefficients, scratch, rows, d);
    if (load) kernels->combine_columns(load, asset->load_coefficients, scratch, rows, d);
    /* PRED may hold anything behind its rows, and padding must not enter sums; LOAD's is zero by rule R14. */
    memset(start + asset->dimension, 0, (d - asset->dimension) * sizeof *start);
}
