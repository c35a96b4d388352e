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

/* The processor is asked directly: the compilers' __builtin_cpu_supports needs a library of theirs, which is not there when
   another compiler links. */

typedef struct cpu_answer {
    uint32_t eax, ebx, ecx, edx;
} cpu_answer;

static cpu_answer ask_cpu(uint32_t leaf)
{
    cpu_answer a;
    __asm__ volatile("cpuid" : "=a"(a.eax), "=b"(a.ebx), "=c"(a.ecx), "=d"(a.edx) : "a"(leaf), "c"(0u));
    return a;
}

/* Which registers the operating system saves: bits 1 and 2 for those of AVX, 5 to 7 for those of AVX-512. */
static uint32_t saved_registers(void)
{
    uint32_t low, high;
    __asm__ volatile(".byte 0x0f, 0x01, 0xd0" /* xgetbv */ : "=a"(low), "=d"(high) : "c"(0u));
    return low;
}

static int has_all(uint32_t bits, uint32_t wanted) { return (bits & wanted) == wanted; }

/* Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2, CPUID: leaf 1 ecx 27 OSXSAVE, 28 AVX; leaf 7 ebx
   5 AVX2, 16 AVX512F, 17 AVX512DQ, 30 AVX512BW, 31 AVX512VL. */
const pliant_kernels* pliant_kernels_choose(void)
{
    const uint32_t avx = 1u << 27 | 1u << 28, avx2 = 1u << 5, avx512 = 1u << 16 | 1u << 17 | 1u << 30 | 1u << 31;
    const uint32_t saved_avx = 1u << 1 | 1u << 2, saved_avx512 = 1u << 5 | 1u << 6 | 1u << 7;
    if (ask_cpu(0).eax < 7 || !has_all(ask_cpu(1).ecx, avx)) return &pliant_kernels_plain;
    const uint32_t saved = saved_registers(), features = ask_cpu(7).ebx;
    if (!has_all(saved, saved_avx) || !has_all(features, avx2)) return &pliant_kernels_plain;
    return has_all(saved, saved_avx512) && has_all(features, avx512) ? &pliant_kernels_avx512 : &pliant_kernels_avx2;
}

#else

const pliant_kernels* pliant_kernels_choose(void) { return &pliant_kernels_plain; }

#endif
