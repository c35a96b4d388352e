/* Dense vectors whose length is a multiple of PLIANT_LANES. Sums run over fixed lanes and end in one fixed tree, so that the
   width of the processor's vectors does not change a bit. */
#ifndef PLIANT_LINALG_H
#define PLIANT_LINALG_H

#include "internal.h"

static PLIANT_INLINE float pliant_sum_lanes(const float* lanes)
{
    float half[8], quarter[4];
    for (int i = 0; i < 8; ++i) half[i] = lanes[i] + lanes[i + 8];
    for (int i = 0; i < 4; ++i) quarter[i] = half[i] + half[i + 4];
    return (quarter[0] + quarter[2]) + (quarter[1] + quarter[3]);
}

static PLIANT_INLINE float pliant_dot(const float* PLIANT_RESTRICT a, const float* PLIANT_RESTRICT b, size_t count)
{
    float sum[PLIANT_LANES] = { 0 };
    for (size_t i = 0; i < count; i += PLIANT_LANES)
        for (size_t l = 0; l < PLIANT_LANES; ++l) sum[l] += a[i + l] * b[i + l];
    return pliant_sum_lanes(sum);
}

/* y = x + factor * direction */
static PLIANT_INLINE void pliant_move(float* PLIANT_RESTRICT y, const float* PLIANT_RESTRICT x, float factor,
                                      const float* PLIANT_RESTRICT direction, size_t count)
{
    for (size_t i = 0; i < count; ++i) y[i] = x[i] + factor * direction[i];
}

/* y += factor * x */
static PLIANT_INLINE void pliant_add_scaled(float* PLIANT_RESTRICT y, float factor, const float* PLIANT_RESTRICT x,
                                            size_t count)
{
    for (size_t i = 0; i < count; ++i) y[i] += factor * x[i];
}

/* The identity in the leading `dimension` rows, zero elsewhere. */
static PLIANT_INLINE void pliant_set_identity(float* matrix, size_t dimension, size_t count)
{
    memset(matrix, 0, count * count * sizeof *matrix);
    for (size_t i = 0; i < dimension; ++i) matrix[i * count + i] = 1.0f;
}

#endif
