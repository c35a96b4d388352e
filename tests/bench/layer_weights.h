/* Weights for benchmarks: sparse random mixtures of layers within their ranges. */
#ifndef PLIANT_BENCH_LAYER_WEIGHTS_H
#define PLIANT_BENCH_LAYER_WEIGHTS_H

#include "../runtime/support.h"

/* Each layer takes part with probability `share`, at least one does; the others have their initial weights. */
static inline void draw_layers(const pliant_asset* asset, float share, uint64_t* random, float* weights)
{
    const uint32_t always = random_below(random, asset->weight_count);
    for (uint32_t k = 0; k < asset->weight_count; ++k) {
        pliant_weight weight;
        pliant_asset_weight(asset, k, &weight);
        const int takes_part = random_unit(random) < share || k == always;
        const float place = random_unit(random);
        weights[k] = takes_part ? weight.low + place * (weight.high - weight.low) : weight.initial;
    }
}

/* The share with which four layers take part on average. */
static inline float sparse_share(const pliant_asset* asset)
{
    return asset->weight_count > 4 ? 4.0f / (float)asset->weight_count : 1.0f;
}

#endif
