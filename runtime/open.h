/* What the files that open an asset share. Hostile bytes are the normal case here: sizes go through pliant_fits() before
   anything is multiplied or added, and nothing is read before its range was checked. */
#ifndef PLIANT_OPEN_H
#define PLIANT_OPEN_H

#include "internal.h"

typedef struct pliant_open_context {
    const unsigned char* blob;
    uint64_t blob_size;
    pliant_format_header header;
    uint64_t dimension; /* padded */
    const pliant_format_chunk* chunks;
} pliant_open_context;

/* The only place that multiplies and adds sizes: *end = start + count * stride if that is at most limit, else 0 is returned.
   No intermediate result can wrap around. */
static inline int pliant_fits(uint64_t start, uint64_t count, uint64_t stride, uint64_t limit, uint64_t* end)
{
    if (start > limit) return 0;
    if (stride != 0 && count > (limit - start) / stride) return 0;
    *end = start + count * stride;
    return 1;
}

static inline int pliant_is_zero(const void* bytes, size_t size)
{
    const unsigned char* p = (const unsigned char*)bytes;
    unsigned char any = 0;
    for (size_t i = 0; i < size; ++i) any |= p[i];
    return any == 0;
}

static inline int pliant_all_finite(const void* bytes, uint64_t count)
{
    const float* values = (const float*)bytes;
    uint32_t bad = 0;
    for (uint64_t i = 0; i < count; ++i) bad |= (uint32_t)!pliant_is_finite(values[i]);
    return bad == 0;
}

/* The first of `count` chunks with this tag, or null. */
const pliant_format_chunk* pliant_open_search(const pliant_format_chunk* chunks, uint32_t count, uint32_t tag);

/* The asset's chunk with this tag, or null. */
const pliant_format_chunk* pliant_open_find(const pliant_open_context* context, uint32_t tag);

/* The count that starts ELEM, QUAR, LAYR, PRED, LOAD, VERT and ANSW and its range, and the reserved words behind it. */
pliant_result pliant_open_count(const pliant_open_context* context, const pliant_format_chunk* chunk, uint32_t limit,
                                uint32_t* count);

/* What a frame reads beside SOLV: LAYR, ELEM or QUAR, PRED, LOAD. The chunks are disjoint and inside the file. */
pliant_result pliant_open_energy(const pliant_open_context* context, pliant_asset* asset);

/* What positions are rebuilt from: REST, BASI or BASC, BNDS. The chunks are disjoint and inside the file. */
pliant_result pliant_open_shape(const pliant_open_context* context, pliant_asset* asset);

/* MRNG, which is optional. */
pliant_result pliant_open_morph_ranges(const pliant_open_context* context, pliant_asset* asset);

#endif
