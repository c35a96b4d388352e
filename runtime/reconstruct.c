/* Positions from reduced coordinates: which tiles a range of vertices needs, and where their positions go. */
#include "internal.h"

#define TILE_VERTICES PLIANT_FORMAT_TILE_VERTICES
#define TILE_FLOATS PLIANT_FORMAT_TILE_FLOATS
#define PARTS PLIANT_FORMAT_COMPACT_PARTS

/* `count` tiles of REST from `tile` on: one, or such as lie in one tile of BASC. */
static void rebuild(const pliant_kernels* kernels, const pliant_asset* asset, const pliant_frame* frame, size_t tile,
                    size_t count, float* out)
{
    const size_t first = tile % PARTS;
    if (asset->columns)
        kernels->rebuild_compact(asset, frame, tile / PARTS, first, first + count, out);
    else
        kernels->rebuild_tile(asset, frame, tile, out);
}

/* The vertices first .. end-1 of BASI or BASC, where tiles follow the order of the vertices. */
static void write_tiles(const pliant_asset* asset, const pliant_frame* frame, size_t first, size_t end, unsigned char* out,
                        size_t stride)
{
    const pliant_kernels* kernels = asset->kernels;
    const size_t tile_end = (end + TILE_VERTICES - 1) / TILE_VERTICES;
    for (size_t v = first; v < end;) {
        const size_t tile = v / TILE_VERTICES, within = v % TILE_VERTICES;
        float buffer[PARTS * TILE_FLOATS];
        const size_t left = tile_end - tile, most = PARTS - tile % PARTS;
        const size_t wanted = !asset->columns ? 1 : left < most ? left : most;
        const int is_direct = stride == 3 * sizeof(float) && within == 0 && (tile + wanted) * TILE_VERTICES <= end;
        rebuild(kernels, asset, frame, tile, wanted, is_direct ? (float*)(void*)out : buffer);
        const size_t stop = (tile + wanted) * TILE_VERTICES < end ? (tile + wanted) * TILE_VERTICES : end;
        if (is_direct)
            out += (stop - v) * stride;
        else
            for (size_t i = within; i < within + stop - v; ++i, out += stride)
                memcpy(out, buffer + 3 * i, 3 * sizeof(float));
        v = stop;
    }
}

/* One tile of BASF, those of its vertices that lie in first .. end-1; `base` is the number of its block's first vertex. */
static void write_product(const pliant_kernels* kernels, const pliant_asset* asset, const pliant_frame* frame, size_t tile,
                          size_t base, size_t first, size_t end, unsigned char* out, size_t stride)
{
    const uint16_t* const vertices = (const uint16_t*)(const void*)(asset->data + asset->products[tile].offset);
    const size_t count = asset->products[tile].vertex_count;
    float buffer[PARTS * TILE_FLOATS];
    if (base + vertices[0] >= end || base + vertices[count - 1] < first) return; /* they are sorted */
    kernels->rebuild_factored(asset, frame, tile, buffer);
    const int is_inside = base + vertices[0] >= first && base + vertices[count - 1] < end;
    for (size_t i = 0; i < count; ++i) {
        const size_t vertex = base + vertices[i];
        const float* const from = buffer + i / TILE_VERTICES * TILE_FLOATS + i % TILE_VERTICES;
        if (!is_inside && (vertex < first || vertex >= end)) continue;
        float* const to = (float*)(void*)(out + (vertex - first) * stride); /* not memcpy: it would gather first */
        to[0] = from[0];
        to[1] = from[TILE_VERTICES];
        to[2] = from[2 * TILE_VERTICES];
    }
}

/* The vertices first .. end-1 of BASF. */
static void write_products(const pliant_asset* asset, const pliant_frame* frame, size_t first, size_t end,
                           unsigned char* out, size_t stride)
{
    const pliant_kernels* kernels = asset->kernels;
    for (size_t block = first / asset->block_vertices; block * asset->block_vertices < end; ++block)
        for (size_t tile = asset->blocks[block]; tile < asset->blocks[block + 1]; ++tile)
            write_product(kernels, asset, frame, tile, block * asset->block_vertices, first, end, out, stride);
}

void pliant_reconstruct_columns(const pliant_asset* asset, const float* q, uint32_t columns, uint32_t first, uint32_t count,
                                float* positions, size_t stride)
{
    if (!asset || !pliant_has_shape(asset) || !q || !positions || first >= asset->vertex_count) return;
    const size_t end = count < asset->vertex_count - first ? (size_t)first + count : asset->vertex_count;
    pliant_frame frame;
    pliant_frame_begin(asset, q, columns, &frame);
    if (asset->products)
        write_products(asset, &frame, first, end, (unsigned char*)positions, stride);
    else
        write_tiles(asset, &frame, first, end, (unsigned char*)positions, stride);
}

uint32_t pliant_range_unit(const pliant_asset* asset)
{
    if (!asset || !pliant_has_shape(asset)) return 0;
    if (asset->products) return asset->block_vertices;
    return asset->columns ? PLIANT_FORMAT_COMPACT_VERTICES : TILE_VERTICES;
}

void pliant_reconstruct(const pliant_asset* asset, const float* q, uint32_t first, uint32_t count, float* positions,
                        size_t stride)
{
    pliant_reconstruct_columns(asset, q, PLIANT_FORMAT_MAX_DIMENSION, first, count, positions, stride);
}
