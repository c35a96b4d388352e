/* Normals of vertices, recomputed from the deformed positions.

   A normal is the direction of the sum of (b - v) x (c - v) over the corners (v, b, c) of triangles at vertex v, that is of
   the triangles' normals weighted by their areas: no division, no arc cosine per face, so no face needs care before its sum,
   and what most engines and three.js compute. Around a vertex neighbours follow each other (the c of one corner is the b of
   the next), so what is stored are runs of them: a vertex inside a surface has one run of valence + 1 indices, the first one
   repeated at the end. Compared with the corners of triangles that is half the memory, and one position is read for a
   triangle and not two or three. */
#include "internal.h"

/* Corners that are put in order together: no vertex of a usual mesh has more, and the time for one that has is still
   linear. */
#define CHAINED_CORNERS 64u

typedef struct corner {
    uint32_t b, c;
} corner;

/* ------------------------------------------------------------------------------------------------------- adjacency ---- */

static uint64_t starts_count(const pliant_asset* asset) { return (uint64_t)asset->vertex_count + 1; }

/* Two words for every corner is what building needs; runs take no more. */
static uint64_t memory_words(const pliant_asset* asset) { return starts_count(asset) + 6 * (uint64_t)asset->triangle_count; }

size_t pliant_normals_size(void) { return sizeof(pliant_normals); }

size_t pliant_normals_memory(const pliant_asset* asset)
{
    if (!asset || !asset->triangles) return 0;
    const uint64_t size = memory_words(asset) * sizeof(uint32_t) + (sizeof(uint32_t) - 1);
    return size <= SIZE_MAX ? (size_t)size : 0;
}

static uint32_t group_of(const pliant_asset* asset, uint32_t vertex)
{
    return asset->smoothing_groups ? asset->smoothing_groups[vertex] : vertex;
}

/* Sorts the corners by group: those of group g are at words starts[g] .. starts[g+1]-1. */
static void collect_corners(const pliant_asset* asset, uint32_t* starts, uint32_t* words)
{
    const size_t group_count = asset->vertex_count, corner_count = 3 * (size_t)asset->triangle_count;
    const uint32_t* triangles = asset->triangles;
    memset(starts, 0, (group_count + 1) * sizeof *starts);
    for (size_t i = 0; i < corner_count; ++i) starts[group_of(asset, triangles[i]) + (size_t)1] += 2;
    for (size_t g = 0; g < group_count; ++g) starts[g + 1] += starts[g];
    for (size_t t = 0; t < corner_count; t += 3) {
        for (size_t i = 0; i < 3; ++i) {
            uint32_t* at = &starts[group_of(asset, triangles[t + i])];
            words[*at] = triangles[t + (i + 1) % 3];
            words[*at + (size_t)1] = triangles[t + (i + 2) % 3];
            *at += 2;
        }
    }
    for (size_t g = group_count; g > 0; --g) starts[g] = starts[g - 1]; /* each start had moved to the next one */
    starts[0] = 0;
}

/* Which corners no other one leads to. */
static uint64_t find_heads(const corner* corners, uint32_t count)
{
    uint64_t heads = 0;
    for (uint32_t i = 0; i < count; ++i) {
        int is_head = 1;
        for (uint32_t j = 0; j < count && is_head; ++j) is_head = corners[j].c != corners[i].b;
        heads |= (uint64_t)is_head << i;
    }
    return heads;
}

/* Writes the run that starts with corner i, and takes its corners out of *left. */
static uint32_t* write_run(const corner* corners, uint32_t count, uint32_t i, uint64_t* left, uint32_t* out)
{
    *out++ = corners[i].b | PLIANT_RUN_START;
    while (i < count) {
        const uint32_t end = corners[i].c;
        *left &= ~((uint64_t)1 << i);
        *out++ = end;
        for (i = 0; i < count; ++i)
            if ((*left >> i & 1) && corners[i].b == end) break;
    }
    return out;
}

/* Open runs first, from their ends; what is left are closed ones, which may start anywhere. */
static uint32_t* write_runs(const corner* corners, uint32_t count, uint32_t* out)
{
    uint64_t left = count < 64 ? ((uint64_t)1 << count) - 1 : ~(uint64_t)0;
    const uint64_t heads = find_heads(corners, count);
    for (uint32_t i = 0; i < count; ++i)
        if (heads >> i & left >> i & 1) out = write_run(corners, count, i, &left, out);
    for (uint32_t i = 0; i < count; ++i)
        if (left >> i & 1) out = write_run(corners, count, i, &left, out);
    return out;
}

/* Corners become runs, in place: a run is never longer than its corners. */
static void chain_corners(size_t group_count, uint32_t* starts, uint32_t* words)
{
    corner corners[CHAINED_CORNERS];
    uint32_t* out = words;
    for (size_t g = 0; g < group_count; ++g) {
        size_t at = starts[g];
        const size_t end = starts[g + 1];
        starts[g] = (uint32_t)(out - words);
        while (at < end) {
            const size_t left = (end - at) / 2;
            const uint32_t count = left < CHAINED_CORNERS ? (uint32_t)left : CHAINED_CORNERS;
            memcpy(corners, words + at, count * sizeof *corners);
            at += 2 * (size_t)count;
            out = write_runs(corners, count, out);
        }
    }
    starts[group_count] = (uint32_t)(out - words);
}

/* Whether the vertices of all groups together read so many neighbours that a frame would take too long. */
static int are_too_large(const pliant_asset* asset, const uint32_t* starts)
{
    const uint64_t limit = ((uint64_t)1 << 22) + 256 * (uint64_t)starts[asset->vertex_count];
    uint64_t reads = 0;
    for (uint32_t v = 0; v < asset->boundary_vertex_count; ++v) {
        const size_t group = group_of(asset, v);
        reads += starts[group + 1] - starts[group];
    }
    return reads > limit;
}

pliant_result pliant_normals_init(pliant_normals* out, const pliant_asset* asset, void* memory, size_t memory_size)
{
    if (!out) return PLIANT_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    const size_t needed = pliant_normals_memory(asset);
    if (needed == 0 || !memory) return PLIANT_ERROR_ARGUMENT;
    if (memory_size < needed) return PLIANT_ERROR_MEMORY_SIZE;

    const size_t skipped = (size_t)(0 - (uintptr_t)memory) % sizeof(uint32_t);
    uint32_t* starts = (uint32_t*)(void*)((unsigned char*)memory + skipped);
    uint32_t* words = starts + starts_count(asset);
    collect_corners(asset, starts, words);
    chain_corners(asset->vertex_count, starts, words);
    if (are_too_large(asset, starts)) return PLIANT_ERROR_LIMIT;
    out->vertex_count = asset->boundary_vertex_count;
    out->neighbour_count = starts[asset->vertex_count];
    out->groups = asset->smoothing_groups;
    out->kernels = pliant_kernels_choose();
    out->starts = starts;
    out->neighbours = words;
    out->memory_used = skipped + ((size_t)starts_count(asset) + out->neighbour_count) * sizeof(uint32_t);
    return PLIANT_OK;
}

/* --------------------------------------------------------------------------------------------------------- normals ---- */

void pliant_normals_compute(const pliant_normals* normals, const float* positions, size_t stride, uint32_t first,
                            uint32_t count, float* out, size_t out_stride)
{
    if (!normals || !normals->starts || !positions || !out || first >= normals->vertex_count) return;
    const pliant_kernels* kernels = normals->kernels;
    const size_t end = count < normals->vertex_count - first ? (size_t)first + count : normals->vertex_count;
    unsigned char* at = (unsigned char*)out;
    for (size_t v = first; v < end;) {
        float block[3 * PLIANT_LANES];
        const size_t lanes = end - v < PLIANT_LANES ? end - v : PLIANT_LANES;
        kernels->normals_of_block(normals, (const unsigned char*)positions, stride, v, lanes, block);
        for (size_t i = 0; i < lanes; ++i, at += out_stride) memcpy(at, block + 3 * i, 3 * sizeof(float));
        v += lanes;
    }
}
