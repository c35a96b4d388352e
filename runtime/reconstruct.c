/* Positions from reduced coordinates: y = origin + rest + U q, tile by tile of 16 vertices. Above some thousand vertices the
   cost is the reading of the basis, so the basis is read once, strictly forwards, into 48 sums that stay in registers. */
#include "internal.h"

#define TILE_VERTICES PLIANT_FORMAT_TILE_VERTICES
#define TILE_FLOATS PLIANT_FORMAT_TILE_FLOATS

static PLIANT_INLINE void rebuild_tile(const pliant_asset* asset, const float* PLIANT_RESTRICT q, size_t tile,
                                       float* PLIANT_RESTRICT out)
{
    const size_t dimension = asset->dimension;
    const float* PLIANT_RESTRICT rest = asset->rest + tile * TILE_FLOATS;
    const float* PLIANT_RESTRICT column = asset->basis + tile * dimension * TILE_FLOATS;
    float sum[TILE_FLOATS];
    memcpy(sum, rest, sizeof sum);
    for (size_t j = 0; j < dimension; ++j, column += TILE_FLOATS) {
        const float qj = q[j];
        for (size_t i = 0; i < TILE_FLOATS; ++i) sum[i] += qj * column[i];
    }
    for (size_t i = 0; i < TILE_VERTICES; ++i)
        for (size_t c = 0; c < 3; ++c) out[3 * i + c] = sum[3 * i + c] + asset->origin[c];
}

PLIANT_KERNEL(rebuild_tile,
              (const pliant_asset* asset, const float* PLIANT_RESTRICT q, size_t tile, float* PLIANT_RESTRICT out),
              (asset, q, tile, out))

void pliant_reconstruct(const pliant_asset* asset, const float* q, uint32_t first, uint32_t count, float* positions,
                        size_t stride)
{
    if (!asset || !asset->basis || !q || !positions || first >= asset->vertex_count) return;
    const pliant_kernels* kernels = pliant_kernels_choose();
    const size_t end = count < asset->vertex_count - first ? (size_t)first + count : asset->vertex_count;
    unsigned char* out = (unsigned char*)positions;
    for (size_t v = first; v < end;) {
        const size_t tile = v / TILE_VERTICES;
        const size_t tile_end = (tile + 1) * TILE_VERTICES < end ? (tile + 1) * TILE_VERTICES : end;
        float rebuilt[TILE_FLOATS];
        kernels->rebuild_tile(asset, q, tile, rebuilt);
        for (; v < tile_end; ++v, out += stride) memcpy(out, rebuilt + 3 * (v % TILE_VERTICES), 3 * sizeof(float));
    }
}
