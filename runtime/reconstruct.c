/* Positions from reduced coordinates: y = origin + rest + U q, tile by tile of 16 vertices. Above some thousand vertices the
   cost is the reading of the basis, so the basis is read once, strictly forwards, into 48 sums that stay in registers. */
#include "internal.h"

#define TILE_VERTICES PLIANT_FORMAT_TILE_VERTICES
#define TILE_FLOATS PLIANT_FORMAT_TILE_FLOATS
#define WORD_BITS 32u

/* ------------------------------------------------------------------------------------------------ single precision ---- */

static PLIANT_INLINE void rebuild_tile(const pliant_asset* asset, const pliant_frame* frame, size_t tile,
                                       float* PLIANT_RESTRICT out)
{
    const float* PLIANT_RESTRICT rest = asset->rest + tile * TILE_FLOATS;
    const float* PLIANT_RESTRICT column = asset->basis + tile * asset->dimension * TILE_FLOATS;
    float sum[TILE_FLOATS];
    memcpy(sum, rest, sizeof sum);
    for (size_t j = 0; j < frame->columns; ++j, column += TILE_FLOATS) {
        const float qj = frame->q[j];
        for (size_t i = 0; i < TILE_FLOATS; ++i) sum[i] += qj * column[i];
    }
    for (size_t i = 0; i < TILE_FLOATS; ++i) out[i] = sum[i] + frame->origin[i];
}

/* --------------------------------------------------------------------------------------------------------- compact ---- */

/* 2^-exponent, of 0 .. 31. */
static PLIANT_INLINE float negative_power(uint32_t exponent)
{
    const uint32_t bits = (127u - exponent) << 23;
    float power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* sum += factor * field. The fields are the `width` bits from bit `shift` of `word` on, and go on in `next` if they do not end there.
   One that does not reach the sign stays where it is, 2^shift times too large: at most 24 bits are exact in single precision
   wherever they are, and the factor makes up for it, exactly. That saves a third of the work. */
static PLIANT_INLINE void add_field(float* PLIANT_RESTRICT sum, float factor, const uint32_t* PLIANT_RESTRICT word,
                                    const uint32_t* PLIANT_RESTRICT next, uint32_t shift, uint32_t width)
{
    const uint32_t end = shift + width;
    if (end < WORD_BITS) {
        const uint32_t mask = ((1u << width) - 1u) << shift;
        const float small = factor * negative_power(shift);
        for (size_t i = 0; i < TILE_FLOATS; ++i) sum[i] += small * (float)(int32_t)(word[i] & mask);
    } else if (end == WORD_BITS) {
        for (size_t i = 0; i < TILE_FLOATS; ++i) sum[i] += factor * (float)(int32_t)(word[i] >> shift);
    } else {
        const uint32_t mask = (1u << (end - WORD_BITS)) - 1u, rest = WORD_BITS - shift;
        for (size_t i = 0; i < TILE_FLOATS; ++i)
            sum[i] += factor * (float)(int32_t)((word[i] >> shift) | ((next[i] & mask) << rest));
    }
}

/* What a part has behind its whole words: `bits` bits a lane, a multiple of 4 below 32. */
static PLIANT_INLINE void read_tail(const unsigned char* PLIANT_RESTRICT bytes, uint32_t bits,
                                    uint32_t* PLIANT_RESTRICT tail)
{
    const size_t half = TILE_FLOATS / 2;
    const uint32_t eights = bits & 16u, fours = bits & 24u; /* where the 8 and the 4 bits begin */
    if (eights) {
        uint16_t halves[TILE_FLOATS];
        memcpy(halves, bytes, sizeof halves);
        for (size_t i = 0; i < TILE_FLOATS; ++i) tail[i] = halves[i];
        bytes += sizeof halves;
    } else
        memset(tail, 0, TILE_FLOATS * sizeof *tail);
    if (bits & 8u) {
        for (size_t i = 0; i < TILE_FLOATS; ++i) tail[i] |= (uint32_t)bytes[i] << eights;
        bytes += TILE_FLOATS;
    }
    if (bits & 4u) {
        for (size_t i = 0; i < half; ++i) tail[i] |= (bytes[i] & 15u) << fours;
        for (size_t i = 0; i < half; ++i) tail[half + i] |= (uint32_t)(bytes[i] >> 4) << fours;
    }
}

/* Adds the fields of one part, weighted, to 48 sums. */
static PLIANT_INLINE void add_part(const pliant_frame* frame, const pliant_format_field* PLIANT_RESTRICT fields,
                                   const uint32_t* PLIANT_RESTRICT words, uint32_t bits, float* PLIANT_RESTRICT sum)
{
    const uint32_t whole = bits / WORD_BITS;
    uint32_t tail[TILE_FLOATS];
    uint32_t at = 0;
    if (bits % WORD_BITS) read_tail((const unsigned char*)(words + (size_t)whole * TILE_FLOATS), bits % WORD_BITS, tail);
    for (size_t j = 0; j < frame->columns; ++j) {
        const uint32_t width = fields[j].width, shift = at % WORD_BITS, k = at / WORD_BITS;
        if (width == 0) continue;
        const uint32_t* const word = k < whole ? words + (size_t)k * TILE_FLOATS : tail;
        const uint32_t* const next = k + 1 < whole ? word + TILE_FLOATS : tail;
        add_field(sum, frame->scaled[j], word, next, shift, width);
        at += width;
    }
}

/* x, y and z for every vertex of a tile. */
static PLIANT_INLINE void spread(const float* xyz, float* PLIANT_RESTRICT lanes)
{
    for (size_t i = 0; i < TILE_VERTICES; ++i)
        for (size_t c = 0; c < 3; ++c) lanes[3 * i + c] = xyz[c];
}

/* Parts first .. end-1 of tile `tile`, 48 floats each. */
static PLIANT_INLINE void rebuild_compact(const pliant_asset* asset, const pliant_frame* frame, size_t tile, size_t first,
                                          size_t end, float* PLIANT_RESTRICT out)
{
    const pliant_format_field* PLIANT_RESTRICT fields = asset->fields + tile * asset->dimension;
    float base[4] = { 0.0f, 0.0f, 0.0f, 0.0f }, bases[TILE_FLOATS];
    uint32_t bits = 0;
    for (size_t j = 0; j < frame->columns; ++j) {
        int16_t numbers[4]; /* the width, too: four lanes are one vector */
        memcpy(numbers, &fields[j], sizeof numbers);
        for (size_t c = 0; c < 4; ++c) base[c] += frame->bases[j] * (float)numbers[c];
    }
    for (size_t j = 0; j < asset->dimension; ++j) bits += fields[j].width;
    spread(base, bases);
    const float factor = asset->tiles[tile].factor;
    const size_t part = pliant_format_compact_part(bits);
    const uint32_t* words = asset->data + asset->tiles[tile].offset + first * part;
    const float* PLIANT_RESTRICT rest = asset->rest + (tile * PLIANT_FORMAT_COMPACT_PARTS + first) * TILE_FLOATS;
    for (; first < end; ++first, words += part, rest += TILE_FLOATS, out += TILE_FLOATS) {
        float sum[TILE_FLOATS];
        memcpy(sum, bases, sizeof sum);
        add_part(frame, fields, words, (bits + 3) / 4 * 4, sum);
        for (size_t i = 0; i < TILE_FLOATS; ++i) out[i] = rest[i] + factor * sum[i] + frame->origin[i];
    }
}

PLIANT_KERNEL(rebuild_tile, (const pliant_asset* asset, const pliant_frame* frame, size_t tile, float* PLIANT_RESTRICT out),
              (asset, frame, tile, out))
PLIANT_KERNEL(rebuild_compact,
              (const pliant_asset* asset, const pliant_frame* frame, size_t tile, size_t first, size_t end,
               float* PLIANT_RESTRICT out),
              (asset, frame, tile, first, end, out))

/* ------------------------------------------------------------------------------------------------------------- API ---- */

void pliant_frame_begin(const pliant_asset* asset, const float* q, uint32_t columns, pliant_frame* frame)
{
    frame->q = q;
    spread(asset->origin, frame->origin);
    frame->columns = columns < asset->dimension ? columns : asset->dimension;
    if (asset->columns)
        for (size_t j = 0; j < frame->columns; ++j) {
            frame->scaled[j] = q[j] * asset->columns[j].scale;
            frame->bases[j] = frame->scaled[j] * (float)(1u << asset->columns[j].shift);
        }
}

/* `count` tiles of REST from `tile` on: one, or such as lie in one tile of BASC. */
static void rebuild(const pliant_kernels* kernels, const pliant_asset* asset, const pliant_frame* frame, size_t tile,
                    size_t count, float* out)
{
    const size_t first = tile % PLIANT_FORMAT_COMPACT_PARTS;
    if (asset->columns)
        kernels->rebuild_compact(asset, frame, tile / PLIANT_FORMAT_COMPACT_PARTS, first, first + count, out);
    else
        kernels->rebuild_tile(asset, frame, tile, out);
}

void pliant_reconstruct_columns(const pliant_asset* asset, const float* q, uint32_t columns, uint32_t first, uint32_t count,
                                float* positions, size_t stride)
{
    if (!asset || !asset->rest || !q || !positions || first >= asset->vertex_count) return;
    const pliant_kernels* kernels = pliant_kernels_choose();
    const size_t end = count < asset->vertex_count - first ? (size_t)first + count : asset->vertex_count;
    const size_t tile_end = (end + TILE_VERTICES - 1) / TILE_VERTICES;
    unsigned char* out = (unsigned char*)positions;
    pliant_frame frame;
    pliant_frame_begin(asset, q, columns, &frame);
    for (size_t v = first; v < end;) {
        const size_t tile = v / TILE_VERTICES, within = v % TILE_VERTICES;
        float buffer[PLIANT_FORMAT_COMPACT_PARTS * TILE_FLOATS];
        const size_t left = tile_end - tile, most = PLIANT_FORMAT_COMPACT_PARTS - tile % PLIANT_FORMAT_COMPACT_PARTS;
        const size_t wanted = !asset->columns ? 1 : left < most ? left : most;
        const int is_direct = stride == 3 * sizeof(float) && within == 0 && (tile + wanted) * TILE_VERTICES <= end;
        rebuild(kernels, asset, &frame, tile, wanted, is_direct ? (float*)(void*)out : buffer);
        const size_t stop = (tile + wanted) * TILE_VERTICES < end ? (tile + wanted) * TILE_VERTICES : end;
        if (is_direct)
            out += (stop - v) * stride;
        else
            for (size_t i = within; i < within + stop - v; ++i, out += stride)
                memcpy(out, buffer + 3 * i, 3 * sizeof(float));
        v = stop;
    }
}

void pliant_reconstruct(const pliant_asset* asset, const float* q, uint32_t first, uint32_t count, float* positions,
                        size_t stride)
{
    pliant_reconstruct_columns(asset, q, PLIANT_FORMAT_MAX_DIMENSION, first, count, positions, stride);
}
