/* What an asset knows as a smooth function of the weights: where a frame starts, z0(w), and the dead load c(w). Cubic radial
   basis functions with a linear part, formats/SPEC.md section 4, PRED and LOAD. */
#include "internal.h"
#include "linalg.h"

#include <math.h>

/* One row of each table that is wanted. */
static void add_rows(const pliant_asset* asset, size_t row, float factor, float* start, float* load)
{
    const size_t d = asset->padded_dimension;
    if (start) pliant_add_scaled(start, factor, asset->predictor_coefficients + row * d, d);
    if (load) pliant_add_scaled(load, factor, asset->load_coefficients + row * d, d);
}

void pliant_radial_evaluate(const pliant_asset* asset, const float* weights, float* start, float* load)
{
    const size_t d = asset->padded_dimension, m = asset->pose_count;
    if (start) memset(start, 0, d * sizeof *start);
    if (load) memset(load, 0, d * sizeof *load);
    if (!asset->predictor_centres || (!start && !load)) return;
    for (uint32_t i = 0; i < asset->predictor_count; ++i) {
        const float* centre = asset->predictor_centres + i * m;
        float square = 0.0f;
        for (size_t k = 0; k < m; ++k) square += (weights[k] - centre[k]) * (weights[k] - centre[k]);
        add_rows(asset, i, square * sqrtf(square), start, load);
    }
    for (size_t k = 0; k < m; ++k) add_rows(asset, asset->predictor_count + k, weights[k], start, load);
    /* PRED may hold anything behind its rows, and padding must not enter sums; LOAD's is zero by rule R14. */
    if (start) memset(start + asset->dimension, 0, (d - asset->dimension) * sizeof *start);
}
