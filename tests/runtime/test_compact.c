/* The compact basis and the bounding boxes: every number of BASC read bit by bit as the SPEC states it, against what
   reconstruction does with it; columns left out; boxes that hold all vertices wherever q is. */
#include "../../formats/pliant_format.h"
#include "support.h"

#include <math.h>

static int compact_count;

/* Row j of the basis at lane `lane` (0 .. 47) of part `part` of the mesh, by the text of the SPEC. */
static double number_at(const opened* o, uint32_t j, uint32_t part, uint32_t lane)
{
    const uint32_t d = o->asset.dimension, t = part / 4;
    size_t size;
    const unsigned char* chunk = pliant_asset_chunk(&o->asset, PLIANT_CHUNK_COMPACT, &size);
    const uint32_t tile_count = *(const uint32_t*)(const void*)chunk;
    const pliant_format_column* columns = (const void*)(chunk + 64);
    const pliant_format_tile* tiles = (const void*)(chunk + 64 + (16 * d + 63) / 64 * 64);
    const pliant_format_field* fields = (const void*)(tiles + tile_count);
    const size_t data_at = ((size_t)((const unsigned char*)(fields + (size_t)tile_count * d) - chunk) + 63) / 64 * 64;
    uint32_t bits = 0, first = 0;
    uint64_t number = 0;
    fields += (size_t)t * d;
    for (uint32_t i = 0; i < d; ++i) bits += fields[i].width;
    for (uint32_t i = 0; i < j; ++i) first += fields[i].width;
    const uint32_t padded = (bits + 3) / 4 * 4, words = padded / 32;
    const unsigned char* bytes = chunk + data_at + 4 * (size_t)tiles[t].offset + (size_t)(part % 4) * 6 * padded;
    for (uint32_t bit = first; bit < first + fields[j].width; ++bit) {
        const unsigned char* at = bytes + 4 * 48 * (size_t)(bit / 32) + 4 * (size_t)lane;
        uint32_t in = bit % 32;
        if (bit / 32 == words) { /* 16, 8 and 4 bits, as many of them as there are */
            const uint32_t tail = padded % 32, eights = tail & 16u, fours = tail & 24u;
            const unsigned char* start = bytes + 4 * 48 * (size_t)words;
            if (in < eights)
                at = start + 2 * lane;
            else if (in < fours) {
                at = start + 6 * eights + lane;
                in -= eights;
            } else {
                at = start + 6 * fours + lane % 24;
                in = in - fours + (lane >= 24 ? 4 : 0);
            }
        }
        number |= (uint64_t)((at[in / 8] >> (in % 8)) & 1u) << (bit - first);
    }
    return (double)tiles[t].factor * (double)columns[j].scale
        * ((double)fields[j].base[lane % 3] * (double)(1u << columns[j].shift) + (double)number);
}

static void check_numbers(const opened* o)
{
    const uint32_t n = o->asset.vertex_count, d = o->asset.dimension;
    size_t rest_size;
    const float* rest = pliant_asset_chunk(&o->asset, PLIANT_CHUNK_REST, &rest_size);
    float q[256], position[3];
    uint64_t state = 5;
    for (int round = 0; round < 4; ++round) {
        for (uint32_t j = 0; j < d; ++j) q[j] = round < 2 ? 4.0f * random_unit(&state) - 2.0f : 0.0f;
        if (round >= 2) q[round == 2 ? 0 : d - 1] = 1.0f;
        for (uint32_t v = 0; v < n; ++v) {
            pliant_reconstruct(&o->asset, q, v, 1, position, 12);
            for (uint32_t c = 0; c < 3; ++c) {
                const uint32_t lane = 3 * (v % 16) + c;
                double expected = (double)o->asset.origin[c] + (double)rest[(size_t)(v / 16) * 48 + lane], size = 1.0;
                for (uint32_t j = 0; j < d; ++j) {
                    const double moved = (double)q[j] * number_at(o, j, v / 16, lane);
                    expected += moved;
                    size += fabs(moved);
                }
                CHECK(fabs((double)position[c] - expected) < 1e-6 * size, "%s: vertex %u, round %d: %.9g, not %.9g", o->name,
                      v, round, (double)position[c], expected);
            }
        }
    }
}

/* Leaving columns out is the same as zeros there, and moves no vertex further than was asked for. */
static void check_columns(const opened* o)
{
    const uint32_t n = o->asset.vertex_count, d = o->asset.dimension;
    float q[256];
    float* all = malloc(3 * sizeof *all * n);
    float* some = malloc(3 * sizeof *some * n);
    uint64_t state = 9;
    int left_out = 0;
    if (!all || !some) exit(2);
    for (int round = 0; round < 60; ++round) {
        for (uint32_t j = 0; j < d; ++j) q[j] = (random_unit(&state) - 0.5f) / (float)(1u + j * (unsigned)(round % 3));
        const float error = 0.5f * powf(random_unit(&state), 4.0f);
        const uint32_t columns = pliant_columns_needed(&o->asset, q, error);
        CHECK(columns <= d, "%s: %u columns", o->name, columns);
        left_out += columns < d;
        pliant_reconstruct(&o->asset, q, 0, n, all, 12);
        pliant_reconstruct_columns(&o->asset, q, columns, 0, n, some, 12);
        for (uint32_t v = 0; v < n; ++v) {
            double moved = 0.0;
            for (int c = 0; c < 3; ++c) moved += pow((double)all[3 * v + c] - (double)some[3 * v + c], 2.0);
            CHECK(sqrt(moved) <= (double)error + 1e-6, "%s: vertex %u moved by %g, allowed %g", o->name, v, sqrt(moved),
                  (double)error);
        }
        for (uint32_t j = columns; j < d; ++j) q[j] = 0.0f;
        pliant_reconstruct(&o->asset, q, 0, n, all, 12);
        for (uint32_t i = 0; i < 3 * n; ++i)
            CHECK(all[i] == some[i], "%s: %g and %g with %u columns", o->name, (double)all[i], (double)some[i], columns);
    }
    CHECK(left_out > 0 || !o->asset.columns, "%s: no frame left columns out", o->name);
    for (uint32_t j = 0; j < d; ++j) q[j] = 0.0f;
    CHECK(pliant_columns_needed(&o->asset, q, 0.0f) == (o->asset.columns ? 0 : d), "%s: q = 0", o->name);
    q[0] = NAN;
    CHECK(pliant_columns_needed(&o->asset, q, 1.0f) == (o->asset.columns ? 1 : d), "%s: not a number", o->name);
    free(all);
    free(some);
}

static void check_descriptions(const opened* o)
{
    pliant_column column;
    for (uint32_t j = 0; j < o->asset.dimension; ++j) {
        CHECK(pliant_asset_column(&o->asset, j, &column) == PLIANT_OK, "%s: column %u", o->name, j);
        if (!o->asset.columns)
            CHECK(isinf(column.reach) && column.bits == 32.0f && column.limit == 0.0f, "%s: column %u", o->name, j);
        else
            CHECK(column.reach >= 0.0f && column.bits > 0.0f && column.bits <= 24.0f && column.limit == 2.0f,
                  "%s: column %u", o->name, j);
    }
    CHECK(pliant_asset_column(&o->asset, o->asset.dimension, &column) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_asset_column(&o->asset, 0, NULL) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_asset_column(NULL, 0, &column) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
}

/* Boxes hold everything, and are the shape's own where there are no clusters. */
static void check_bounds(const opened* o)
{
    const uint32_t n = o->asset.vertex_count, d = o->asset.dimension;
    static const float sizes[] = { 0.0f, 0.01f, 0.3f, 1.0f, 30.0f, 1e6f };
    float q[256], low[3], high[3];
    float* positions = malloc(3 * sizeof *positions * n);
    uint64_t state = 13;
    if (!positions) exit(2);
    for (int round = 0; round < 300 / SLOWNESS; ++round) {
        for (uint32_t j = 0; j < d; ++j) q[j] = sizes[round % 6] * (random_unit(&state) - 0.5f);
        if (round % 7 == 0)
            memcpy(q, pliant_asset_pose_coordinates(&o->asset, (unsigned)round % o->asset.pose_count), 4 * d);
        CHECK(pliant_bounds(&o->asset, q, low, high) == PLIANT_OK, "%s", o->name);
        pliant_reconstruct(&o->asset, q, 0, n, positions, 12);
        for (int c = 0; c < 3; ++c) {
            float lowest = positions[c], highest = positions[c];
            for (uint32_t v = 0; v < n; ++v) {
                lowest = fminf(lowest, positions[3 * v + c]);
                highest = fmaxf(highest, positions[3 * v + c]);
            }
            CHECK(low[c] <= lowest && highest <= high[c], "%s: round %d: %.9g .. %.9g is not in %.9g .. %.9g", o->name,
                  round, (double)lowest, (double)highest, (double)low[c], (double)high[c]);
            if (!o->asset.bounds) CHECK(low[c] == lowest && high[c] == highest, "%s: round %d is loose", o->name, round);
        }
    }
    CHECK(pliant_bounds(NULL, q, low, high) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_bounds(&o->asset, NULL, low, high) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_bounds(&o->asset, q, NULL, high) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_bounds(&o->asset, q, low, NULL) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    free(positions);
}

static void check_asset(const opened* o)
{
    if (o->asset.columns) check_numbers(o);
    compact_count += o->asset.columns != NULL;
    check_columns(o);
    check_descriptions(o);
    check_bounds(o);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_asset);
    CHECK(compact_count >= 4, "only %d compact assets", compact_count);
    return report("compact");
}
