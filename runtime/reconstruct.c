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
        float buffer[PARTS * TILE_FLOATS];
        const size_t left = tile_end - tile, most = PARTS - tile % PARTS;
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
