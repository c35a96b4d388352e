/* The compact and the factored basis and the bounding boxes: every number read bit by bit as the SPEC states it, against
   what reconstruction does with it; columns left out; boxes that hold all vertices wherever q is. */
#include "../../formats/pliant_format.h"
#include "support.h"

#include <math.h>

static int compact_count, factored_count;

/* `width` bits from bit `first` on of lane `lane` of a part that starts at `bytes` and has `padded` bits a lane. */
static uint64_t field_at(const unsigned char* bytes, uint32_t padded, uint32_t lane, uint32_t first, uint32_t width)
{
    const uint32_t words = padded / 32;
    uint64_t number = 0;
    for (uint32_t bit = first; bit < first + width; ++bit) {
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
    return number;
}

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
    fields += (size_t)t * d;
    for (uint32_t i = 0; i < d; ++i) bits += fields[i].width;
    for (uint32_t i = 0; i < j; ++i) first += fields[i].width;
    const uint32_t padded = (bits + 3) / 4 * 4;
    const unsigned char* bytes = chunk + data_at + 4 * (size_t)tiles[t].offset + (size_t)(part % 4) * 6 * padded;
    const uint64_t number = field_at(bytes, padded, lane, first, fields[j].width);
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

/* The tiles of BASF, one after the other as the SPEC states them: the data of one starts where that of the last ended. */
typedef struct product {
    uint32_t count, column_count, parts, rows, bits;
    const float *rest_origin, *scales, *still;
    float rest_scale;
    const uint16_t *vertices, *numbers;
    const int16_t* right;
    const pliant_format_field* fields;
    const unsigned char *left, *end;
} product;

static product read_product(const unsigned char* record, const unsigned char* data, uint32_t d)
{
    product p;
    memset(&p, 0, sizeof p);
    p.count = *(const uint16_t*)(const void*)(record + 4);
    p.column_count = *(const uint16_t*)(const void*)(record + 6);
    p.rest_origin = (const float*)(const void*)(record + 8);
    p.rest_scale = p.rest_origin[3];
    p.parts = (p.count + 15) / 16;
    p.vertices = (const uint16_t*)(const void*)data;
    p.still = p.scales = (const float*)(const void*)(p.vertices + 16 * p.parts);
    p.end = (const unsigned char*)(p.still + 48 * p.parts);
    if (p.rest_scale == 0.0f) return p;
    p.rows = (12 + p.column_count + 7) / 8 * 8;
    p.right = (const int16_t*)(const void*)(p.scales + p.rows);
    p.fields = (const pliant_format_field*)(const void*)(p.right + (size_t)p.rows * d);
    p.numbers = (const uint16_t*)(const void*)(p.fields + p.column_count);
    p.left = (const unsigned char*)(p.numbers + 48 * p.parts);
    for (uint32_t i = 0; i < p.column_count; ++i) p.bits += p.fields[i].width;
    p.bits = (p.bits + 3) / 4 * 4;
    p.end = p.left + (size_t)p.parts * 6 * p.bits;
    return p;
}

/* Row i of the right factor times q. */
static double row_at(const opened* o, const product* p, const float* q, uint32_t i)
{
    size_t size;
    const unsigned char* chunk = pliant_asset_chunk(&o->asset, PLIANT_CHUNK_FACTORED, &size);
    const pliant_format_column* columns = (const void*)(chunk + 64);
    double sum = 0.0;
    for (uint32_t j = 0; j < o->asset.dimension; ++j)
        sum += (double)p->right[j * p->rows + i] * (double)columns[j].scale * (double)q[j];
    return (double)p->scales[i] * sum;
}

/* Coordinate c of vertex v of a tile; `size` grows by what was added up. */
static double place_at(const opened* o, const product* p, const float* q, uint32_t v, uint32_t c, double* size)
{
    const uint32_t lane = 48 * (v / 16) + v % 16;
    const double origin = (double)o->asset.origin[c];
    if (p->rest_scale == 0.0f) return origin + (double)p->still[lane + 16 * c];
    double sum = row_at(o, p, q, c);
    *size += fabs(sum);
    for (uint32_t a = 0; a < 3; ++a) {
        const double moved = row_at(o, p, q, 3 + 3 * a + c) * p->numbers[lane + 16 * a];
        sum += moved;
        *size += fabs(moved);
    }
    for (uint32_t i = 0, first = 0; i < p->column_count; first += p->fields[i++].width) {
        const uint32_t width = p->fields[i].width;
        const double unit = width > 15 ? ldexp(1.0, (int)width - 15) : 1.0;
        const uint64_t field = field_at(p->left + (size_t)(v / 16) * 6 * p->bits, p->bits, v % 16 + 16 * c, first, width);
        const double moved = row_at(o, p, q, 12 + i) * ((double)p->fields[i].base[c] * unit + (double)field);
        sum += moved;
        *size += fabs(moved);
    }
    return origin + (double)p->rest_origin[c] + (double)p->rest_scale * p->numbers[lane + 16 * c] + sum;
}

/* Every vertex of every tile against what reconstruction says of it, alone and in the range of all. */
static void check_products(const opened* o)
{
    const uint32_t n = o->asset.vertex_count, d = o->asset.dimension;
    size_t size;
    const unsigned char* chunk = pliant_asset_chunk(&o->asset, PLIANT_CHUNK_FACTORED, &size);
    const uint32_t tile_count = *(const uint32_t*)(const void*)chunk, per_block = *(const uint32_t*)(const void*)(chunk + 8);
    const uint32_t block_count = (n + per_block - 1) / per_block;
    const uint32_t* blocks = (const void*)(chunk + 64 + (16 * d + 63) / 64 * 64);
    const size_t tiles_at = ((size_t)((const unsigned char*)(blocks + block_count + 1) - chunk) + 63) / 64 * 64;
    float q[256], position[3];
    float* all = malloc(12 * (size_t)n);
    uint64_t state = 5;
    if (!all) exit(2);
    CHECK(pliant_range_unit(&o->asset) == per_block, "%s: unit of ranges", o->name);
    for (int round = 0; round < 3; ++round) {
        const unsigned char* data = chunk + (tiles_at + 24 * (size_t)tile_count + 63) / 64 * 64;
        uint32_t block = 0;
        for (uint32_t j = 0; j < d; ++j) q[j] = round < 2 ? 4.0f * random_unit(&state) - 2.0f : 0.0f;
        pliant_reconstruct(&o->asset, q, 0, n, all, 12);
        for (uint32_t t = 0; t < tile_count; ++t) {
            const product p = read_product(chunk + tiles_at + 24 * (size_t)t, data, d);
            while (t >= blocks[block + 1]) ++block;
            for (uint32_t v = 0; v < p.count; ++v) {
                const uint32_t vertex = block * per_block + p.vertices[v];
                pliant_reconstruct(&o->asset, q, vertex, 1, position, 12);
                CHECK(memcmp(position, all + 3 * (size_t)vertex, 12) == 0, "%s: vertex %u alone", o->name, vertex);
                for (uint32_t c = 0; c < 3; ++c) {
                    double scale = 1.0;
                    const double expected = place_at(o, &p, q, v, c, &scale);
                    CHECK(fabs((double)position[c] - expected) < 2e-6 * scale, "%s: vertex %u, round %d: %.9g, not %.9g",
                          o->name, vertex, round, (double)position[c], expected);
                }
            }
            data = p.end;
        }
        CHECK(data == chunk + size, "%s: the data ends elsewhere", o->name);
    }
    free(all);
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
            CHECK(column.reach >= 0.0f && column.bits > 0.0f && (column.bits <= 24.0f || o->asset.products)
                      && column.limit == 2.0f,
                  "%s: column %u", o->name, j);
    }
    CHECK(pliant_asset_column(&o->asset, o->asset.dimension, &column) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_asset_column(&o->asset, 0, NULL) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_asset_column(NULL, 0, &column) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
}

/* Boxes hold everything, and are the shape's own where there are no clusters. */
/* Rest positions of a damaged asset may be anything: the box holds those that are numbers. */
static void check_bounds_of_nan(const opened* o, const float* q)
{
    size_t size;
    float low[3], high[3];
    float* rest = (float*)pliant_asset_chunk(&o->asset, PLIANT_CHUNK_REST, &size); /* in memory of the test */
    if (o->asset.bounds || !rest) return;
    const float x = rest[0]; /* of vertex 0 */
    rest[0] = NAN;
    CHECK(pliant_bounds(&o->asset, q, low, high) == PLIANT_OK, "%s", o->name);
    rest[0] = x;
    for (int c = 0; c < 3; ++c) CHECK(low[c] <= high[c], "%s: the box is not one of numbers", o->name);
}

/* Coordinates that are not numbers leave vertices where they are that do not depend on them. */
static void check_bounds_of_lost_coordinates(const opened* o, float* positions)
{
    const uint32_t n = o->asset.vertex_count, d = o->asset.dimension;
    const float lost[] = { NAN, INFINITY, -INFINITY };
    float q[256] = { 0.0f }, low[3], high[3];
    for (uint32_t j = 0; j < 3 * d; ++j) {
        q[j / 3] = lost[j % 3];
        CHECK(pliant_bounds(&o->asset, q, low, high) == PLIANT_OK, "%s", o->name);
        pliant_reconstruct(&o->asset, q, 0, n, positions, 12);
        q[j / 3] = 0.0f;
        for (uint32_t i = 0; i < 3 * n; ++i)
            if (isfinite(positions[i]))
                CHECK(low[i % 3] <= positions[i] && positions[i] <= high[i % 3], "%s: q[%u]", o->name, j / 3);
    }
}

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
    check_bounds_of_nan(o, q);
    check_bounds_of_lost_coordinates(o, positions);
    CHECK(pliant_bounds(NULL, q, low, high) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_bounds(&o->asset, NULL, low, high) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_bounds(&o->asset, q, NULL, high) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    CHECK(pliant_bounds(&o->asset, q, low, NULL) == PLIANT_ERROR_ARGUMENT, "%s", o->name);
    free(positions);
}

static void check_asset(const opened* o)
{
    if (o->asset.tiles) check_numbers(o);
    if (o->asset.products) check_products(o);
    compact_count += o->asset.tiles != NULL;
    factored_count += o->asset.products != NULL;
    check_columns(o);
    check_descriptions(o);
    check_bounds(o);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_asset);
    CHECK(compact_count >= 4, "only %d compact assets", compact_count);
    CHECK(factored_count >= 3, "only %d factored assets", factored_count);
    return report("compact");
}
