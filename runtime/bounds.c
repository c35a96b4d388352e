/* What is known of a shape without rebuilding it: boxes, how far columns reach, how many of them a frame needs. */
#include "internal.h"

#include <math.h>

#define EPSILON 5.9604644775390625e-8 /* 2^-24, of single precision: half a unit in the last place of 1 */

/* ------------------------------------------------------------------------------------------------------- columns ---- */

uint32_t pliant_columns_needed(const pliant_asset* asset, const float* q, float error)
{
    if (!asset || !q) return 0;
    if (!asset->columns) return asset->dimension;
    double moved = 0.0;
    uint32_t count = asset->dimension;
    for (; count > 0; --count) {
        const double qj = (double)q[count - 1];
        moved += (qj < 0.0 ? -qj : qj) * (double)asset->columns[count - 1].reach;
        if (!(moved <= (double)error)) break; /* also where it is not a number */
    }
    return count;
}

pliant_result pliant_asset_column(const pliant_asset* asset, uint32_t column, pliant_column* out)
{
    if (!asset || !pliant_has_shape(asset) || !out || column >= asset->dimension) return PLIANT_ERROR_ARGUMENT;
    if (!asset->columns) {
        const uint32_t infinity = 0x7F800000u;
        memcpy(&out->reach, &infinity, sizeof out->reach);
        out->limit = 0.0f;
        out->bits = 32.0f;
        return PLIANT_OK;
    }
    out->reach = asset->columns[column].reach;
    out->limit = asset->columns[column].limit;
    if (asset->products) { /* the columns share the left factors */
        size_t size;
        pliant_asset_chunk(asset, PLIANT_CHUNK_FACTORED, &size);
        out->bits = (float)(8.0 * (double)size / (3.0 * (double)asset->vertex_count * (double)asset->dimension));
        return PLIANT_OK;
    }
    const uint32_t tile_count = (asset->vertex_count - 1) / PLIANT_FORMAT_COMPACT_VERTICES + 1;
    double bits = 0.0;
    for (uint32_t t = 0; t < tile_count; ++t) bits += asset->fields[(size_t)t * asset->dimension + column].width;
    out->bits = (float)(bits / (double)tile_count);
    return PLIANT_OK;
}

/* --------------------------------------------------------------------------------------------------------- boxes ---- */

typedef struct box {
    double lowest[3], highest[3];
    int is_empty;
} box;

/* What is not a number is left out, and replaced where it came first. */
static void include(box* b, int c, double lowest, double highest)
{
    if (b->is_empty || lowest < b->lowest[c] || b->lowest[c] != b->lowest[c]) b->lowest[c] = lowest;
    if (b->is_empty || highest > b->highest[c] || b->highest[c] != b->highest[c]) b->highest[c] = highest;
}

/* `row` has the cluster's 1 + d intervals. The sums that reconstruction rounds have at most d + 4 terms (bases, fields,
   rest, factor, origin), some of them products of three rounded numbers, and none of their partial sums exceeds `size`: so 2
   (d + 8) roundings of it cover theirs. In a compact basis a number is a base plus a field, each of them at most twice the
   column's reach. A factored basis has sums of sums, of at most d terms for each row, d columns and their bases; the SPEC
   bounds its terms by eight times the reach. */
static void include_cluster(box* b, const pliant_asset* asset, const pliant_format_interval* row, const float* q)
{
    const double dimension = (double)asset->dimension;
    const double roundings = (asset->products ? 3.0 * dimension + 64.0 : 2.0 * (dimension + 8.0)) * EPSILON;
    const double terms = asset->products ? 8.0 : 4.0;
    for (int c = 0; c < 3; ++c) {
        const double origin = (double)asset->origin[c]; /* is in the centre, too, and may cancel the rest there */
        double centre = (double)row[0].centre[c], radius = (double)row[0].radius[c];
        double size = (centre < 0.0 ? -centre : centre) + radius + 2.0 * (origin < 0.0 ? -origin : origin);
        for (uint32_t j = 0; j < asset->dimension; ++j) {
            const double qj = (double)q[j], moved = qj * (double)row[1 + j].centre[c];
            const double spread = (qj < 0.0 ? -qj : qj) * (double)row[1 + j].radius[c];
            centre += moved;
            radius += spread;
            size += asset->columns ? terms * (qj < 0.0 ? -qj : qj) * (double)asset->columns[j].reach
                                   : (moved < 0.0 ? -moved : moved) + spread;
        }
        const double lowest = centre - radius - roundings * size, highest = centre + radius + roundings * size;
        const int is_known = lowest <= highest; /* else q is not of numbers, and may leave some vertices where they are */
        include(b, c, is_known ? lowest : -HUGE_VAL, is_known ? highest : HUGE_VAL);
    }
    b->is_empty = 0;
}

static void include_position(box* b, float x, float y, float z)
{
    include(b, 0, (double)x, (double)x);
    include(b, 1, (double)y, (double)y);
    include(b, 2, (double)z, (double)z);
    b->is_empty = 0;
}

/* Without clusters: all vertices, a tile of BASF at a time. */
static void include_products(box* b, const pliant_asset* asset, const float* q)
{
    const pliant_kernels* kernels = asset->kernels;
    const size_t blocks = pliant_format_block_count(asset->vertex_count, asset->block_vertices);
    float positions[3 * PLIANT_FORMAT_COMPACT_VERTICES];
    pliant_frame frame;
    pliant_frame_begin(asset, q, asset->dimension, &frame);
    for (size_t t = 0; t < asset->blocks[blocks]; ++t) {
        kernels->rebuild_factored(asset, &frame, t, positions);
        for (size_t i = 0; i < asset->products[t].vertex_count; ++i) {
            const float* x
                = positions + i / PLIANT_FORMAT_TILE_VERTICES * PLIANT_FORMAT_TILE_FLOATS + i % PLIANT_FORMAT_TILE_VERTICES;
            include_position(b, x[0], x[PLIANT_FORMAT_TILE_VERTICES], x[2 * PLIANT_FORMAT_TILE_VERTICES]);
        }
    }
}

/* The same, of the other forms. */
static void include_vertices(box* b, const pliant_asset* asset, const float* q)
{
    float positions[3 * PLIANT_FORMAT_COMPACT_VERTICES];
    for (uint32_t v = 0; v < asset->vertex_count; v += PLIANT_FORMAT_COMPACT_VERTICES) {
        const uint32_t left = asset->vertex_count - v;
        const uint32_t count = left < PLIANT_FORMAT_COMPACT_VERTICES ? left : PLIANT_FORMAT_COMPACT_VERTICES;
        pliant_reconstruct(asset, q, v, count, positions, 3 * sizeof(float));
        for (uint32_t i = 0; i < count; ++i)
            include_position(b, positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
    }
}

/* The nearest single-precision number may lie inside the box: one step of the last place outwards is enough. */
static float rounded_down(double value)
{
    const float nearest = (float)value;
    return (double)nearest <= value ? nearest : (float)(value - 2.0 * EPSILON * (value < 0.0 ? -value : value) - 1e-44);
}

pliant_result pliant_bounds(const pliant_asset* asset, const float* q, float lowest[3], float highest[3])
{
    if (!asset || !pliant_has_shape(asset) || !q || !lowest || !highest) return PLIANT_ERROR_ARGUMENT;
    box b = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 1 };
    const size_t intervals = 1 + (size_t)asset->dimension;
    for (uint32_t k = 0; k < asset->cluster_count; ++k) include_cluster(&b, asset, asset->bounds + k * intervals, q);
    if (asset->cluster_count == 0) (asset->products ? include_products : include_vertices)(&b, asset, q);
    for (int c = 0; c < 3; ++c) {
        lowest[c] = rounded_down(b.lowest[c]);
        highest[c] = -rounded_down(-b.highest[c]);
    }
    return PLIANT_OK;
}
