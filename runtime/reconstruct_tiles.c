/* The kernels of reconstruction: y = origin + rest + U q for one tile of 16 or 64 vertices, U as it is or as a product.
   Above some thousand vertices the cost is the reading of the basis, so the basis is read once, strictly forwards or nearly
   so, into sums that stay in registers. */
#include "internal.h"

/* Shuffles that no compiler finds in a loop over bytes, without headers: gcc 12 and clang. Integers only, or the same
   operations on floats as the loops beside them: the same bits with and without. */
#define HAS_VECTORS 0
#if defined(__GNUC__) && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector) && __has_builtin(__builtin_convertvector)
#undef HAS_VECTORS
#define HAS_VECTORS 1
#endif
#endif

/* Before a loop over the parts of a tile: unrolled, their sums can be registers. */
#if defined(__GNUC__) && !defined(__clang__)
#define UNROLL _Pragma("GCC unroll 4")
/* Before a short loop over lanes: gcc would unroll it and then find no vectors in what it has made. */
#define KEEP_LOOP _Pragma("GCC unroll 1")
#else
#define UNROLL
#define KEEP_LOOP
#endif

#define TILE_VERTICES PLIANT_FORMAT_TILE_VERTICES
#define TILE_FLOATS PLIANT_FORMAT_TILE_FLOATS
#define PARTS PLIANT_FORMAT_COMPACT_PARTS
#define WORD_BITS 32u
#define CACHE_LINE 64u
#define AHEAD 512u /* bytes: so far behind the next tile fetching goes, for the loads of one come earlier than its end */

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

/* A word of every lane of every part: those of part p lie at `first + p * stride`. */
typedef struct word_rows {
    const uint32_t* first;
    size_t stride;
} word_rows;

/* 2^-exponent, of 0 .. 31. */
static PLIANT_INLINE float negative_power(uint32_t exponent)
{
    const uint32_t bits = (127u - exponent) << 23;
    float power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* sum += factor * field, of fields that end in the word where they begin. One that does not reach the sign stays where it
   is, 2^shift times too large: at most 24 bits are exact in single precision wherever they are, and the factor makes up for
   it, exactly. That saves a third of the work. */
static PLIANT_INLINE void add_inner(float* PLIANT_RESTRICT sum, size_t parts, float factor, word_rows word, uint32_t mask)
{
    UNROLL
    for (size_t p = 0; p < parts; ++p)
        for (size_t i = 0; i < TILE_FLOATS; ++i)
            sum[p * TILE_FLOATS + i] += factor * (float)(int32_t)(word.first[p * word.stride + i] & mask);
}

/* As add_inner, for fields that reach the end of the word or continue in `next`. */
static PLIANT_INLINE void add_crossing(float* PLIANT_RESTRICT sum, size_t parts, float factor, word_rows word,
                                       word_rows next, uint32_t shift, uint32_t mask)
{
    UNROLL
    for (size_t p = 0; p < parts; ++p)
        for (size_t i = 0; i < TILE_FLOATS; ++i) {
            const uint32_t low = word.first[p * word.stride + i] >> shift,
                           high = next.first[p * next.stride + i] << (WORD_BITS - shift);
            sum[p * TILE_FLOATS + i] += factor * (float)(int32_t)((low | high) & mask);
        }
}

#if HAS_VECTORS
typedef uint8_t bytes_16 __attribute__((vector_size(16)));
typedef uint16_t halves_8 __attribute__((vector_size(16)));
typedef int32_t integers_4 __attribute__((vector_size(16)));
typedef float floats_4 __attribute__((vector_size(16)));

static PLIANT_INLINE bytes_16 load_bytes(const unsigned char* bytes)
{
    bytes_16 value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static PLIANT_INLINE halves_8 low_halves(halves_8 a, halves_8 b)
{
    return __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
}

static PLIANT_INLINE halves_8 high_halves(halves_8 a, halves_8 b)
{
    return __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
}

/* Half bytes 16 i .. 16 i + 15 of the 48 in 24 bytes: first the low halves, then the high ones. */
static PLIANT_INLINE bytes_16 load_fours(const unsigned char* bytes, size_t i)
{
    const bytes_16 first = load_bytes(bytes), last = load_bytes(bytes + 8);
    if (i == 0) return first & 15;
    if (i == 2) return last >> 4;
    return __builtin_shufflevector(last & 15, first >> 4, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23);
}

/* Eight lanes of 32 bits from their lower and their upper halves. */
static PLIANT_INLINE void store_lanes(uint32_t* PLIANT_RESTRICT lanes, halves_8 lower, halves_8 upper)
{
    const halves_8 first = low_halves(lower, upper), last = high_halves(lower, upper);
    memcpy(lanes, &first, sizeof first);
    memcpy(lanes + 4, &last, sizeof last);
}

/* What a part has behind its whole words, `bits` bits a lane, spread over 32-bit lanes. */
static PLIANT_INLINE void read_tail(const unsigned char* bytes, uint32_t bits, uint32_t* PLIANT_RESTRICT tail)
{
    const bytes_16 none = { 0 };
    const halves_8 zero = { 0 };
    const unsigned char *const at8 = bytes + 6 * (bits & 16u), *const at4 = bytes + 6 * (bits & 24u);
    UNROLL
    for (size_t i = 0; i < 3; ++i) {
        const bytes_16 fours = bits & 4u ? load_fours(at4, i) : none, low = bits & 8u ? load_bytes(at8 + 16 * i) : fours,
                       high = bits & 8u ? fours : none;
        const halves_8 first
            = (halves_8)__builtin_shufflevector(low, high, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23),
            last
            = (halves_8)__builtin_shufflevector(low, high, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
        if (bits & 16u) {
            store_lanes(tail + 16 * i, (halves_8)load_bytes(bytes + 32 * i), first);
            store_lanes(tail + 16 * i + 8, (halves_8)load_bytes(bytes + 32 * i + 16), last);
        } else {
            store_lanes(tail + 16 * i, first, zero);
            store_lanes(tail + 16 * i + 8, last, zero);
        }
    }
}
#else
static PLIANT_INLINE void read_tail(const unsigned char* PLIANT_RESTRICT bytes, uint32_t bits,
                                    uint32_t* PLIANT_RESTRICT tail)
{
    const size_t half = TILE_FLOATS / 2;
    const uint32_t eights = bits & 16u, fours = bits & 24u; /* where the 8 and the 4 bits begin */
    const unsigned char *const at8 = bytes + 6 * eights, *const at4 = bytes + 6 * fours;
    memset(tail, 0, TILE_FLOATS * sizeof *tail);
    if (eights)
        for (size_t i = 0; i < TILE_FLOATS; ++i) tail[i] = bytes[2 * i] | (uint32_t)bytes[2 * i + 1] << 8;
    if (bits & 8u)
        for (size_t i = 0; i < TILE_FLOATS; ++i) tail[i] |= (uint32_t)at8[i] << eights;
    if (bits & 4u) {
        for (size_t i = 0; i < half; ++i) tail[i] |= (at4[i] & 15u) << fours;
        for (size_t i = 0; i < half; ++i) tail[half + i] |= (uint32_t)(at4[i] >> 4) << fours;
    }
}
#endif

/* The same for `parts` parts, `stride` bytes apart. */
static PLIANT_INLINE void read_equal_tails(const unsigned char* bytes, size_t stride, size_t parts, uint32_t bits,
                                           uint32_t* PLIANT_RESTRICT tail)
{
    for (size_t p = 0; p < parts; ++p) read_tail(bytes + p * stride, bits, tail + p * TILE_FLOATS);
}

/* Code of its own for each number of bits: a multiple of 4 below 32. */
static PLIANT_INLINE void read_tails(const unsigned char* bytes, size_t stride, size_t parts, uint32_t bits,
                                     uint32_t* PLIANT_RESTRICT tail)
{
    switch (bits) {
    case 4: read_equal_tails(bytes, stride, parts, 4, tail); break;
    case 8: read_equal_tails(bytes, stride, parts, 8, tail); break;
    case 12: read_equal_tails(bytes, stride, parts, 12, tail); break;
    case 16: read_equal_tails(bytes, stride, parts, 16, tail); break;
    case 20: read_equal_tails(bytes, stride, parts, 20, tail); break;
    case 24: read_equal_tails(bytes, stride, parts, 24, tail); break;
    case 28: read_equal_tails(bytes, stride, parts, 28, tail); break;
    default: break;
    }
}

/* Fields of a tile's columns, and what they are multiplied by: `factor * weights[j]`. */
typedef struct packed_columns {
    const pliant_format_field* fields;
    const float* weights;
    float factor;
    size_t count;
    size_t part_words; /* of one part */
    uint32_t whole;    /* words of 32 bits a lane in it, before the tail */
} packed_columns;

/* What the parts of a compact tile share. */
typedef struct compact_tile {
    packed_columns columns;
    float bases[TILE_FLOATS]; /* the sum of the columns' bases, for every vertex */
} compact_tile;

/* Words k of the lanes of every part: behind the whole ones lies the tail, which was unpacked. */
static PLIANT_INLINE word_rows rows_at(const packed_columns* columns, const uint32_t* words, const uint32_t* tail,
                                       uint32_t k)
{
    const int is_whole = k < columns->whole; /* else words there may be past the end of the file */
    const word_rows rows
        = { is_whole ? words + (size_t)k * TILE_FLOATS : tail, is_whole ? columns->part_words : TILE_FLOATS };
    return rows;
}

/* Adds the fields of `parts` parts, weighted, to their sums: column by column, so that what a column needs is worked out
   once for all parts. */
static PLIANT_INLINE void add_parts(const packed_columns* columns, const uint32_t* words, const uint32_t* tail, size_t parts,
                                    float* PLIANT_RESTRICT sum)
{
    uint32_t at = 0;
    for (size_t j = 0; j < columns->count; ++j) {
        const uint32_t width = columns->fields[j].width, shift = at % WORD_BITS, k = at / WORD_BITS,
                       mask = (1u << width) - 1u;
        if (width == 0) continue;
        const float factor = columns->factor * columns->weights[j];
        const word_rows word = rows_at(columns, words, tail, k);
        if (shift + width < WORD_BITS)
            add_inner(sum, parts, factor * negative_power(shift), word, mask << shift);
        else
            add_crossing(sum, parts, factor, word, rows_at(columns, words, tail, k + 1), shift, mask);
        at += width;
    }
}

/* x, y and z for every vertex of a tile. */
static PLIANT_INLINE void spread(const float* xyz, float* PLIANT_RESTRICT lanes)
{
    for (size_t i = 0; i < TILE_VERTICES; ++i)
        for (size_t c = 0; c < 3; ++c) lanes[3 * i + c] = xyz[c];
}

/* Words of 4 bytes in one part of a tile. */
static PLIANT_INLINE size_t part_words(const pliant_asset* asset, size_t tile)
{
    uint32_t bits = 0;
    if ((tile + 1) * PLIANT_FORMAT_COMPACT_VERTICES < asset->vertex_count)
        return (asset->tiles[tile + 1].offset - asset->tiles[tile].offset) / PARTS;
    for (size_t j = 0; j < asset->dimension; ++j) bits += asset->fields[tile * asset->dimension + j].width;
    return pliant_format_compact_part(bits);
}

#if HAS_VECTORS
/* sum + weights * four integers, those in the upper halves of the lanes. */
static PLIANT_INLINE floats_4 add_upper_halves(floats_4 sum, const float* weights, halves_8 lanes)
{
    floats_4 factors;
    memcpy(&factors, weights, sizeof factors);
    return sum + factors * __builtin_convertvector((integers_4)lanes >> 16, floats_4);
}
#endif

/* The bases of a tile's columns, weighted: those of even columns and of odd ones are added up apart, which is a shorter
   chain. */
static PLIANT_INLINE void sum_bases(const pliant_frame* frame, const pliant_format_field* PLIANT_RESTRICT fields,
                                    float* PLIANT_RESTRICT base)
{
    const float* weights = frame->bases;
    size_t j = 0;
#if HAS_VECTORS
    floats_4 even = { 0.0f }, odd = { 0.0f };
    for (; j + 2 <= frame->columns; j += 2, weights += 8) {
        halves_8 numbers;
        memcpy(&numbers, fields + j, sizeof numbers);
        even = add_upper_halves(even, weights, low_halves(numbers, numbers));
        odd = add_upper_halves(odd, weights + 4, high_halves(numbers, numbers));
    }
    if (j < frame->columns) {
        halves_8 numbers = { 0 };
        memcpy(&numbers, fields + j, sizeof *fields);
        even = add_upper_halves(even, weights, low_halves(numbers, numbers));
    }
    even += odd;
    memcpy(base, &even, sizeof even);
#else
    float sum[2][3] = { { 0.0f }, { 0.0f } };
    for (; j < frame->columns; ++j, weights += 4)
        for (size_t c = 0; c < 3; ++c) sum[j % 2][c] += weights[c] * (float)fields[j].base[c];
    for (size_t c = 0; c < 3; ++c) base[c] = sum[0][c] + sum[1][c];
#endif
}

static PLIANT_INLINE void rebuild_parts(const pliant_frame* frame, const compact_tile* tile, const uint32_t* words,
                                        const uint32_t* tail, const float* PLIANT_RESTRICT rest, size_t parts,
                                        float* PLIANT_RESTRICT out)
{
    float sum[PARTS * TILE_FLOATS];
    UNROLL
    for (size_t p = 0; p < parts; ++p)
        for (size_t i = 0; i < TILE_FLOATS; ++i) sum[p * TILE_FLOATS + i] = tile->columns.factor * tile->bases[i];
    add_parts(&tile->columns, words, tail, parts, sum);
    UNROLL
    for (size_t p = 0; p < parts; ++p)
        for (size_t i = 0; i < TILE_FLOATS; ++i)
            out[p * TILE_FLOATS + i] = rest[p * TILE_FLOATS + i] + sum[p * TILE_FLOATS + i] + frame->origin[i];
}

/* Asks for `size` bytes from AHEAD behind `bytes` on. Nothing needs to be there. */
static PLIANT_INLINE void fetch(const void* bytes, size_t size)
{
#if defined(__GNUC__)
    const uintptr_t start = (uintptr_t)bytes + AHEAD;
    for (size_t i = 0; i < size; i += CACHE_LINE) __builtin_prefetch((const void*)(start + i));
#else
    (void)bytes;
    (void)size;
#endif
}

/* Parts first .. end-1 of tile `tile`, 48 floats each. */
static PLIANT_INLINE void rebuild_compact(const pliant_asset* asset, const pliant_frame* frame, size_t tile, size_t first,
                                          size_t end, float* PLIANT_RESTRICT out)
{
    const size_t parts = end - first, part = part_words(asset, tile);
    const uint32_t* const words = asset->data + asset->tiles[tile].offset + first * part;
    const float* const rest = asset->rest + (tile * PARTS + first) * TILE_FLOATS;
    const uint32_t bits = (uint32_t)(part / pliant_format_compact_part(4) * 4);
    uint32_t tail[PARTS * TILE_FLOATS];
    float base[4];
    compact_tile shared;
    fetch(words + parts * part, parts * part * sizeof *words);
    fetch(rest + parts * TILE_FLOATS, parts * TILE_FLOATS * sizeof *rest);
    const packed_columns columns = { asset->fields + tile * asset->dimension,
                                     frame->scaled,
                                     asset->tiles[tile].factor,
                                     frame->columns,
                                     part,
                                     bits / WORD_BITS };
    shared.columns = columns;
    sum_bases(frame, columns.fields, base);
    spread(base, shared.bases);
    read_tails((const unsigned char*)(words + (size_t)columns.whole * TILE_FLOATS), part * sizeof *words, parts,
               bits % WORD_BITS, tail);
    if (parts == PARTS)
        rebuild_parts(frame, &shared, words, tail, rest, PARTS, out);
    else
        for (size_t p = 0; p < parts; ++p)
            rebuild_parts(frame, &shared, words + p * part, tail + p * TILE_FLOATS, rest + p * TILE_FLOATS, 1,
                          out + p * TILE_FLOATS);
}

/* -------------------------------------------------------------------------------------------------------- factored ---- */

#define AFFINE_ROWS PLIANT_FORMAT_AFFINE_ROWS
#define ROW_GROUP PLIANT_FORMAT_ROW_GROUP
#define MOST_ROWS (PLIANT_FORMAT_MAX_PRODUCT_COLUMNS + AFFINE_ROWS + ROW_GROUP)

/* rows += the product of the `width` columns from `column` on with q, 4 or 1: of four the chain of additions is a fourth as
   long. By groups of rows: a compiler that takes 16 rows at a time would leave 8 to scalar code. */
static PLIANT_INLINE void add_columns(const float* q, const int16_t* PLIANT_RESTRICT column, size_t width, size_t count,
                                      float* PLIANT_RESTRICT rows)
{
    const int16_t *const second = column + count, *const third = second + count, *const fourth = third + count;
    for (size_t first = 0; first < count; first += ROW_GROUP) {
        KEEP_LOOP
        for (size_t i = first; i < first + ROW_GROUP; ++i)
            rows[i] += width == 4
                ? (q[0] * (float)column[i] + q[1] * (float)second[i]) + (q[2] * (float)third[i] + q[3] * (float)fourth[i])
                : q[0] * (float)column[i];
    }
}

/* rows[i] = scales[i] * (right factor * q)[i]. Columns that a frame leaves out count as zeros: the same bits either way. */
static PLIANT_INLINE void multiply_right(const pliant_frame* frame, size_t dimension, const float* PLIANT_RESTRICT scales,
                                         const int16_t* right, size_t count, float* PLIANT_RESTRICT rows)
{
    const size_t grouped = dimension / 4 * 4;
    memset(rows, 0, count * sizeof *rows);
    for (size_t j = 0; j < grouped && j < frame->columns; j += 4)
        add_columns(frame->scaled + j, right + j * count, 4, count, rows);
    for (size_t j = grouped; j < frame->columns; ++j) add_columns(frame->scaled + j, right + j * count, 1, count, rows);
    for (size_t i = 0; i < count; ++i) rows[i] *= scales[i];
}

/* One coordinate of 16 vertices: sum = constant + linear . x, x being three rows of 16. */
static PLIANT_INLINE void begin_lanes(float constant, float along_x, float along_y, float along_z,
                                      const float* PLIANT_RESTRICT x, float* PLIANT_RESTRICT sum)
{
    KEEP_LOOP
    for (size_t i = 0; i < TILE_VERTICES; ++i)
        sum[i] = constant + along_x * x[i] + along_y * x[TILE_VERTICES + i] + along_z * x[2 * TILE_VERTICES + i];
}

/* out = (scale * x + sum) + origin */
static PLIANT_INLINE void end_lanes(float scale, float origin, const float* PLIANT_RESTRICT x,
                                    const float* PLIANT_RESTRICT sum, float* PLIANT_RESTRICT out)
{
    KEEP_LOOP
    for (size_t i = 0; i < TILE_VERTICES; ++i) out[i] = (scale * x[i] + sum[i]) + origin;
}

static PLIANT_INLINE void rebuild_still(const pliant_frame* frame, const float* PLIANT_RESTRICT rest, size_t parts,
                                        float* PLIANT_RESTRICT out)
{
    for (size_t p = 0; p < 3 * parts; ++p)
        for (size_t i = 0; i < TILE_VERTICES; ++i)
            out[p * TILE_VERTICES + i] = rest[p * TILE_VERTICES + i] + frame->origin[p % 3];
}

/* The sums of `parts` parts, `tail` and `x` being theirs. */
static PLIANT_INLINE void rebuild_products(const pliant_frame* frame, const pliant_format_product* tile,
                                           const packed_columns* columns, const float* rows, const float* constant,
                                           const uint32_t* words, const uint32_t* tail, const float* x, size_t parts,
                                           float* PLIANT_RESTRICT out)
{
    float sum[PARTS * TILE_FLOATS];
    UNROLL
    for (size_t p = 0; p < parts; ++p)
        for (size_t c = 0; c < 3; ++c)
            begin_lanes(constant[c], rows[3 + c], rows[6 + c], rows[9 + c], x + p * TILE_FLOATS,
                        sum + p * TILE_FLOATS + c * TILE_VERTICES);
    add_parts(columns, words, tail, parts, sum);
    for (size_t p = 0; p < 3 * parts; ++p)
        end_lanes(tile->rest_scale, tile->rest_origin[p % 3] + frame->origin[p % 3], x + p * TILE_VERTICES,
                  sum + p * TILE_VERTICES, out + p * TILE_VERTICES);
}

/* All vertices of a tile: per part 16 times x, then y, then z. */
static PLIANT_INLINE void rebuild_factored(const pliant_asset* asset, const pliant_frame* frame, size_t index,
                                           float* PLIANT_RESTRICT out)
{
    const pliant_format_product* const tile = asset->products + index;
    const size_t parts = pliant_format_product_parts(tile), count = pliant_format_product_rows(tile);
    const uint32_t* const start = asset->data + tile->offset;
    const float* const scales = (const float*)(const void*)(start + parts * (TILE_VERTICES / 2));
    if (count == 0) {
        rebuild_still(frame, scales, parts, out);
        return;
    }
    const uint32_t* const behind = start + pliant_format_product_fields(tile, asset->dimension);
    const pliant_format_field* const fields = (const pliant_format_field*)(const void*)behind;
    const uint16_t* const numbers = (const uint16_t*)(const void*)(fields + tile->column_count);
    const uint32_t* const words = behind + pliant_format_product_left(tile);
    float rows[MOST_ROWS], x[PARTS * TILE_FLOATS], constant[3];
    uint32_t tail[PARTS * TILE_FLOATS], bits = 0;
    multiply_right(frame, asset->dimension, scales, (const int16_t*)(const void*)(scales + count), count, rows);
    memcpy(constant, rows, sizeof constant);
    for (size_t j = 0; j < tile->column_count; ++j) {
        const float unit = (float)(1u << pliant_format_product_shift(fields[j].width));
        bits += fields[j].width;
        for (size_t c = 0; c < 3; ++c) constant[c] += rows[AFFINE_ROWS + j] * ((float)fields[j].base[c] * unit);
    }
    for (size_t i = 0; i < parts * TILE_FLOATS; ++i) x[i] = (float)numbers[i];
    const size_t part = pliant_format_compact_part(bits);
    bits = (bits + 3) / 4 * 4;
    const packed_columns columns = { fields, rows + AFFINE_ROWS, 1.0f, tile->column_count, part, bits / WORD_BITS };
    read_tails((const unsigned char*)(words + (size_t)columns.whole * TILE_FLOATS), part * sizeof *words, parts,
               bits % WORD_BITS, tail);
    if (parts == PARTS)
        rebuild_products(frame, tile, &columns, rows, constant, words, tail, x, PARTS, out);
    else
        for (size_t p = 0; p < parts; ++p)
            rebuild_products(frame, tile, &columns, rows, constant, words + p * part, tail + p * TILE_FLOATS,
                             x + p * TILE_FLOATS, 1, out + p * TILE_FLOATS);
}

PLIANT_KERNEL(rebuild_tile, (const pliant_asset* asset, const pliant_frame* frame, size_t tile, float* PLIANT_RESTRICT out),
              (asset, frame, tile, out))
PLIANT_WIDE_KERNEL(rebuild_compact,
                   (const pliant_asset* asset, const pliant_frame* frame, size_t tile, size_t first, size_t end,
                    float* PLIANT_RESTRICT out),
                   (asset, frame, tile, first, end, out))
PLIANT_WIDE_KERNEL(rebuild_factored,
                   (const pliant_asset* asset, const pliant_frame* frame, size_t tile, float* PLIANT_RESTRICT out),
                   (asset, frame, tile, out))

/* ----------------------------------------------------------------------------------------------------------- frame ---- */

void pliant_frame_begin(const pliant_asset* asset, const float* q, uint32_t columns, pliant_frame* frame)
{
    frame->q = q;
    spread(asset->origin, frame->origin);
    frame->columns = columns < asset->dimension ? columns : asset->dimension;
    if (!asset->columns) return;
    for (size_t j = frame->columns; j % 4 != 0; ++j) frame->scaled[j] = 0.0f; /* the rest of a group of columns */
    for (size_t j = 0; j < frame->columns; ++j) {
        frame->scaled[j] = q[j] * asset->columns[j].scale;
        for (size_t c = 0; c < 4; ++c)
            frame->bases[4 * j + c] = c < 3 ? frame->scaled[j] * (float)(1u << asset->columns[j].shift) : 0.0f;
    }
}
