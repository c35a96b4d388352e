/* Tiles of the compact basis with fields of all widths, wherever they begin and end and whatever is left behind the last
   whole word: every set of kernels gives the numbers that the SPEC states, and all give the same bits, for whole tiles and
   for their parts. */
#include "internal.h"
#include "support.h"

#include <math.h>

enum { VERTICES = 232, TILES = 4, PARTS = 4, LAST_PARTS = 3, LANES = 48, MOST = 40 };

/* An asset of nothing but a compact basis. Every array is as long as it must be: the sanitizers see what is read
   behind it. */
typedef struct packed {
    pliant_asset asset;
    pliant_format_column columns[MOST];
    pliant_format_tile tiles[TILES];
    pliant_format_field* fields;
    uint32_t* data;
    float* rest;
    uint32_t part_words[TILES];
} packed;

static int seen_tail[8];                          /* tiles by the bits behind their last whole word, in fours */
static int seen_inner, seen_upper, seen_crossing; /* fields by where they end */

static void* allocate(size_t size)
{
    void* memory = malloc(size > 0 ? size : 1);
    if (!memory) exit(2);
    return memory;
}

static uint32_t parts_of(size_t tile) { return tile + 1 < TILES ? PARTS : LAST_PARTS; }

static void count_fields(const pliant_format_field* fields, uint32_t dimension)
{
    uint32_t at = 0;
    for (uint32_t j = 0; j < dimension; at += fields[j++].width) {
        const uint32_t end = at % 32 + fields[j].width;
        if (fields[j].width > 0) ++*(end < 32 ? &seen_inner : end == 32 ? &seen_upper : &seen_crossing);
    }
    ++seen_tail[(at + 3) / 4 % 8];
}

static void make(packed* out, uint32_t dimension, uint64_t* state)
{
    uint32_t words = 0;
    const uint32_t widest = 1 + random_below(state, 25);
    memset(out, 0, sizeof *out);
    out->fields = allocate(sizeof *out->fields * TILES * dimension);
    out->rest = allocate(sizeof(float) * (VERTICES + 15) / 16 * LANES);
    for (uint32_t i = 0; i < (VERTICES + 15) / 16 * LANES; ++i) out->rest[i] = random_unit(state);
    for (uint32_t j = 0; j < dimension; ++j) {
        out->columns[j].scale = 1e-4f * (0.5f + random_unit(state));
        out->columns[j].shift = random_below(state, 6);
    }
    for (uint32_t t = 0; t < TILES; ++t) {
        pliant_format_field* fields = out->fields + (size_t)t * dimension;
        uint32_t bits = 0;
        for (uint32_t j = 0; j < dimension; ++j) {
            for (int c = 0; c < 3; ++c) fields[j].base[c] = (int16_t)((int)random_below(state, 2001) - 1000);
            fields[j].width = (uint16_t)(random_below(state, 4) ? random_below(state, widest) : 0);
            bits += fields[j].width;
        }
        count_fields(fields, dimension);
        out->part_words[t] = pliant_format_compact_part(bits);
        out->tiles[t].offset = words;
        out->tiles[t].factor = 0.5f + random_unit(state);
        words += out->part_words[t] * parts_of(t);
    }
    out->data = allocate(sizeof *out->data * words);
    for (uint32_t i = 0; i < words; ++i) out->data[i] = random_below(state, 65536) << 16 | random_below(state, 65536);
    out->asset.vertex_count = VERTICES;
    out->asset.dimension = dimension;
    out->asset.columns = out->columns;
    out->asset.tiles = out->tiles;
    out->asset.fields = out->fields;
    out->asset.data = out->data;
    out->asset.rest = out->rest;
    for (int c = 0; c < 3; ++c) out->asset.origin[c] = random_unit(state);
}

/* Bit `bit` of lane `lane` of a part with `bits` bits a lane, by the text of the SPEC. */
static uint32_t bit_at(const unsigned char* part, uint32_t bits, uint32_t bit, uint32_t lane)
{
    const uint32_t tail = bits % 32;
    uint32_t in = bit % 32;
    if (bit < bits - tail) return part[192 * (bit / 32) + 4 * lane + in / 8] >> in % 8 & 1u;
    part += 6 * (size_t)(bits - tail);
    if (tail & 16u) {
        if (in < 16) return part[2 * lane + in / 8] >> in % 8 & 1u;
        part += 96;
        in -= 16;
    }
    if (tail & 8u) {
        if (in < 8) return part[lane] >> in & 1u;
        part += 48;
        in -= 8;
    }
    return part[lane % 24] >> (lane < 24 ? in : in + 4) & 1u;
}

static void check_lane(const packed* p, const float* q, uint32_t tile, uint32_t part, uint32_t lane, float got)
{
    const pliant_format_field* fields = p->fields + (size_t)tile * p->asset.dimension;
    const uint32_t words = p->part_words[tile];
    const unsigned char* bytes = (const unsigned char*)(p->data + p->tiles[tile].offset + part * words);
    const double rest = (double)p->rest[(tile * PARTS + part) * LANES + lane] + (double)p->asset.origin[lane % 3];
    double expected = rest, size = 1.0;
    uint32_t at = 0;
    for (uint32_t j = 0; j < p->asset.dimension; at += fields[j++].width) {
        double number = ldexp((double)fields[j].base[lane % 3], (int)p->columns[j].shift);
        for (uint32_t b = 0; b < fields[j].width; ++b)
            number += ldexp((double)bit_at(bytes, words / 6 * 4, at + b, lane), (int)b);
        number *= (double)q[j] * (double)p->columns[j].scale * (double)p->tiles[tile].factor;
        expected += number;
        size += fabs(number);
    }
    CHECK(fabs((double)got - expected) < 1e-6 * size, "d = %u, tile %u, part %u, lane %u: %.9g, not %.9g",
          p->asset.dimension, tile, part, lane, (double)got, expected);
}

/* What the plain kernels make of whole tiles is right; all kernels make the same of them and of their parts. */
static void check_tiles(const packed* p, const float* q, uint32_t columns, const pliant_kernels* const* kernels)
{
    pliant_frame frame;
    pliant_frame_begin(&p->asset, q, columns, &frame);
    for (uint32_t t = 0; t < TILES; ++t) {
        const size_t parts = parts_of(t);
        float expected[PARTS * LANES], got[PARTS * LANES];
        pliant_kernels_plain.rebuild_compact(&p->asset, &frame, t, 0, parts, expected);
        if (columns == p->asset.dimension)
            for (uint32_t i = 0; i < parts * LANES; ++i) check_lane(p, q, t, i / LANES, i % LANES, expected[i]);
        for (size_t k = 0; kernels[k]; ++k)
            for (size_t first = 0; first < parts; ++first)
                for (size_t end = first + 1; end <= parts; ++end) {
                    kernels[k]->rebuild_compact(&p->asset, &frame, t, first, end, got);
                    CHECK(memcmp(got, expected + first * LANES, (end - first) * LANES * sizeof *got) == 0,
                          "kernels %u, d = %u, tile %u, parts %u to %u: other bits", (unsigned)k, p->asset.dimension, t,
                          (unsigned)first, (unsigned)end);
                }
    }
}

int main(void)
{
    const pliant_kernels* kernels[4] = { &pliant_kernels_plain, NULL, NULL, NULL };
    const pliant_kernels* const chosen = pliant_kernels_choose();
    uint64_t state = 83;
    size_t count = 1;
#if PLIANT_HAS_AVX2_COPY
    if (chosen == &pliant_kernels_avx512) kernels[count++] = &pliant_kernels_avx2;
#endif
    if (chosen != &pliant_kernels_plain) kernels[count++] = chosen;
    for (int round = 0; round < 400 / SLOWNESS; ++round) {
        const uint32_t dimension = 1 + random_below(&state, round % 2 ? MOST : 6);
        float q[MOST];
        packed p;
        make(&p, dimension, &state);
        for (uint32_t j = 0; j < dimension; ++j) q[j] = 4.0f * random_unit(&state) - 2.0f;
        check_tiles(&p, q, dimension, kernels);
        check_tiles(&p, q, random_below(&state, dimension + 1), kernels);
        free(p.fields);
        free(p.data);
        free(p.rest);
    }
    for (int i = 0; i < 8; ++i) CHECK(seen_tail[i] > 0, "no tile with %d bits behind its words", 4 * i);
    CHECK(seen_inner && seen_upper && seen_crossing, "%d, %d, %d fields", seen_inner, seen_upper, seen_crossing);
    printf("%u sets of kernels\n", (unsigned)count);
    return report("unpack");
}
