/* Which kernels a processor gets, and those of dense algebra. */
#include "internal.h"
#include "linalg.h"

/* So much of a product at a time that it stays in the first-level cache while the columns stream through: those of a quartic
   are hundreds of kilobytes long. */
#define COMBINED_FLOATS 1024u

static PLIANT_INLINE void combine_columns(float* PLIANT_RESTRICT y, const float* PLIANT_RESTRICT matrix,
                                          const float* PLIANT_RESTRICT x, size_t columns, size_t count)
{
    for (size_t start = 0; start < count; start += COMBINED_FLOATS) {
        const size_t floats = count - start < COMBINED_FLOATS ? count - start : COMBINED_FLOATS;
        const float* column = matrix + start;
        memset(y + start, 0, floats * sizeof *y);
        for (size_t j = 0; j < columns; ++j, column += count)
            if (x[j] != 0.0f) pliant_add_scaled(y + start, x[j], column, floats); /* most sliders of a face are at rest */
    }
}

/* Both triangles get the same two products in the same order up to commutation, which floating point respects: a symmetric
   matrix stays symmetric to the bit. */
static PLIANT_INLINE void add_symmetric(float* PLIANT_RESTRICT matrix, const float* PLIANT_RESTRICT u,
                                        const float* PLIANT_RESTRICT v, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        float* PLIANT_RESTRICT row = matrix + i * count;
        const float ui = u[i], vi = v[i];
        for (size_t j = 0; j < count; ++j) row[j] += ui * v[j] + vi * u[j];
    }
}

PLIANT_KERNEL(combine_columns,
              (float* PLIANT_RESTRICT y, const float* PLIANT_RESTRICT matrix, const float* PLIANT_RESTRICT x, size_t columns,
               size_t count),
              (y, matrix, x, columns, count))
PLIANT_KERNEL(add_symmetric,
              (float* PLIANT_RESTRICT matrix, const float* PLIANT_RESTRICT u, const float* PLIANT_RESTRICT v, size_t count),
              (matrix, u, v, count))

#define PLAIN(type, name, widest) pliant_##name,
const pliant_kernels pliant_kernels_plain = { PLIANT_KERNELS(PLAIN) };

#if PLIANT_HAS_AVX2_COPY

#define AVX2(type, name, widest) pliant_##name##_avx2,
#define WIDEST(type, name, widest) pliant_##name##_##widest,
const pliant_kernels pliant_kernels_avx2 = { PLIANT_KERNELS(AVX2) };
const pliant_kernels pliant_kernels_avx512 = { PLIANT_KERNELS(WIDEST) };

const pliant_kernels* pliant_kernels_choose(void)
{
    __builtin_cpu_init(); /* for callers that run before the C library's constructors do */
    if (!__builtin_cpu_supports("avx2")) return &pliant_kernels_plain;
    const int is_wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw")
        && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    return is_wide ? &pliant_kernels_avx512 : &pliant_kernels_avx2;
}

#else

const pliant_kernels* pliant_kernels_choose(void) { return &pliant_kernels_plain; }

#endif
