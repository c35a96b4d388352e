/* Reduced coordinates as weights of morph targets: an affine map per coordinate, with ranges that the bake has found. */
#include "open.h"

pliant_result pliant_open_morph_ranges(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_MORPH_RANGES);
    const size_t dimension = context->header.dimension, padded = (size_t)context->dimension;
    uint64_t end;
    if (!chunk) return PLIANT_OK;
    if (!pliant_fits(0, 2 * context->dimension, sizeof(float), chunk->size, &end) || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    const float* low = (const float*)(const void*)(context->blob + chunk->offset);
    const float* high = low + padded;
    if (!pliant_all_finite(low, 2 * context->dimension)) return PLIANT_ERROR_NUMBER;
    for (size_t j = 0; j < dimension; ++j) {
        const float width = high[j] - low[j]; /* may overflow */
        if (!(width >= 0.0f) || !pliant_is_finite(width)) return PLIANT_ERROR_NUMBER;
    }
    const size_t padding = (padded - dimension) * sizeof(float);
    if (!pliant_is_zero(low + dimension, padding) || !pliant_is_zero(high + dimension, padding)) return PLIANT_ERROR_LAYOUT;
    asset->morph_ranges = low;
    return PLIANT_OK;
}

pliant_result pliant_morph_weights(const pliant_asset* asset, const float* q, float* weights)
{
    if (!asset || !q || !weights) return PLIANT_ERROR_ARGUMENT;
    if (!asset->morph_ranges) return PLIANT_ERROR_ABSENT;
    const float* low = asset->morph_ranges;
    const float* high = low + asset->padded_dimension;
    for (size_t j = 0; j < asset->dimension; ++j) {
        const float width = high[j] - low[j];
        weights[j] = width > 0.0f ? (q[j] - low[j]) / width : 0.0f; /* a target that moves nothing */
    }
    return PLIANT_OK;
}
