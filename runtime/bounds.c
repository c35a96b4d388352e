/* What is known of a shape without rebuilding it: boxes, how far columns reach, how many of them a frame needs. */
#include "internal.h"

#define EPSILON 0x1p-24 /* of single precision: half a unit in the last place of 1 */

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
    if (!asset || !asset->rest || !out || column >= asset->dimension) return PLIANT_ERROR_ARGUMENT;
    if (!asset->columns) {
        const uint32_t infinity = 0x7F800000u;
        memcpy(&out->reach, &infinity, sizeof out->reach);
        out->limit = 0.0f;
        out->bits = 32.0f;
        return PLIANT_OK;
    }
    out->reach = asset->columns[column].reach;
    out->limit = asset->columns[column].limit;
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

static void include(box* b, int c, double lowest, double highest)
{
    if (b->is_empty || lowest < b->lowest[c]) b->lowest[c] = lowest;
    if (b->is_empty || highest > b->highest[c]) b->highest[c] = highest;
}

/* `row` has the cluster's 1 + d intervals. The sums that reconstruction rounds have at most d + 4 terms (bases, fields,
   rest, factor, origin), some of them products of three rounded numbers, and none of their partial sums exceeds `size`: so 2
   (d + 8) roundings of it cover theirs. In a compact basis a number is a base plus a field, each of them at most twice the
   column's reach. */
static void include_cluster(box* b, const pliant_asset* asset, const pliant_format_interval* row, const float* q)
{
    const double roundings = 2.0 * ((double)asset->dimension + 8.0) * EPSILON;
    for (int c = 0; c < 3; ++c) {
        const double origin = (double)asset->origin[c]; /* is in the centre, too, and may cancel the rest there */
        double centre = (double)row[0].centre[c], radius = (double)row[0].radius[c];
        double size = (centre < 0.0 ? -centre : centre) + radius + 2.0 * (origin < 0.0 ? -origin : origin);
        for (uint32_t j = 0; j < asset->dimension; ++j) {
            const double qj = (double)q[j], moved = qj * (double)row[1 + j].centre[c];
            const double spread = (qj < 0.0 ? -qj : qj) * (double)row[1 + j].radius[c];
            centre += moved;
            radius += spread;
            size += asset->columns ? 4.0 * (qj < 0.0 ? -qj : qj) * (double)asset->columns[j].reach
                                   : (moved < 0.0 ? -moved : moved) + spread;
        }
        include(b, c, centre - radius - roundings * size, centre + radius + roundings * size);
    }
    b->is_empty = 0;
}

/* Without clusters: all vertices, some at a time. */
static void include_vertices(box* b, const pliant_asset* asset, const float* q)
{
    float positions[3 * PLIANT_FORMAT_COMPACT_VERTICES];
    for (uint32_t v = 0; v < asset->vertex_count; v += PLIANT_FORMAT_COMPACT_VERTICES) {
        const uint32_t left = asset->vertex_count - v;
        const uint32_t count = left < PLIANT_FORMAT_COMPACT_VERTICES ? left : PLIANT_FORMAT_COMPACT_VERTICES;
        pliant_reconstruct(asset, q, v, count, positions, 3 * sizeof(float));
        for (uint32_t i = 0; i < count; ++i) {
            for (int c = 0; c < 3; ++c) include(b, c, (double)positions[3 * i + c], (double)positions[3 * i + c]);
            b->is_empty = 0;
        }
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
    if (!asset || !asset->rest || !q || !lowest || !highest) return PLIANT_ERROR_ARGUMENT;
    box b = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 1 };
    const size_t intervals = 1 + (size_t)asset->dimension;
    for (uint32_t k = 0; k < asset->cluster_count; ++k) include_cluster(&b, asset, asset->bounds + k * intervals, q);
    if (asset->cluster_count == 0) include_vertices(&b, asset, q);
    for (int c = 0; c < 3; ++c) {
        lowest[c] = rounded_down(b.lowest[c]);
        highest[c] = -rounded_down(-b.highest[c]);
    }
    return PLIANT_OK;
}
