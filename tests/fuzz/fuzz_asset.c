/* libFuzzer target: any bytes through open (a quarter with verified checksums), frames with ordinary and odd weights,
   reconstruction, bounds, normals, columns, morph weights and the small accessors: everything that a game calls. The custom
   mutator (mutate_asset.c) repairs checksums, as a hostile file would have the right ones.

   Made for speed: no allocation, files of some kilobytes, few evaluations of the surrogate energy. Memory comes from static
   areas whose other bytes are poisoned, so AddressSanitizer sees the first byte past it. */
#include "arena.h"
#include "pliant.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

#define VERTICES 32u
#define GAP 0x5A

/* For the blob, for solver or adjacency, for positions. What a host would refuse to allocate is not the library's affair: no
   solver beyond its area. */
#define BLOB_CAPACITY ((size_t)1 << 18)
#define WORK_CAPACITY ((size_t)1 << 20)
#define OUTPUT_CAPACITY ((size_t)1 << 16)
static __attribute__((aligned(64))) unsigned char all_memory[BLOB_CAPACITY + WORK_CAPACITY + OUTPUT_CAPACITY];
static fuzz_area blob_area = { all_memory, BLOB_CAPACITY, 0 };
static fuzz_area work_area = { all_memory + BLOB_CAPACITY, WORK_CAPACITY, 0 };
static fuzz_area output_area = { all_memory + BLOB_CAPACITY + WORK_CAPACITY, OUTPUT_CAPACITY, 0 };

static void require(int condition)
{
    if (!condition) abort();
}

/* Numbers that no artist sends, and one that many do. */
static const float odd_numbers[]
    = { 0.0f, -0.0f, 1.0f, 1e-45f, 1e-30f, 3e38f, -1.0f, 1e20f, -3.4028e38f, (float)(1e-7), (float)HUGE_VAL, (float)NAN };

static float pick(uint32_t* seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return odd_numbers[(*seed >> 16) % (sizeof odd_numbers / sizeof *odd_numbers)];
}

/* Bad weights change nothing, good ones give a finite q. */
static void solve_frame(const pliant_asset* asset, pliant_solver* solver, const float* weights, float* q)
{
    pliant_solve_info info;
    float before[256];
    memcpy(before, q, asset->dimension * sizeof *q);
    const pliant_result result = pliant_solve(solver, weights, q, &info);
    if (result != PLIANT_OK) {
        require(result >= PLIANT_ERROR_WEIGHT_NOT_FINITE && memcmp(before, q, asset->dimension * sizeof *q) == 0);
        return;
    }
    require(info.evaluations <= 3);
    for (uint32_t j = 0; j < asset->dimension; ++j) require(q[j] - q[j] == 0.0f);
}

/* Two frames of ordinary weights, of which the second continues the first; then one of odd ones. */
static void solve_frames(const pliant_asset* asset, pliant_solver* solver, uint32_t seed, float* q)
{
    float weights[64];
    memset(q, 0, 256 * sizeof *q);
    for (uint32_t frame = 0; frame < 2; ++frame) {
        for (uint32_t k = 0; k < asset->weight_count; ++k) weights[k] = 1.0f + 0.01f * (float)(k * frame);
        solve_frame(asset, solver, weights, q);
        require(frame > 0 || q[0] - q[0] == 0.0f);
    }
    for (uint32_t k = 0; k < asset->weight_count; ++k) weights[k] = pick(&seed);
    solve_frame(asset, solver, weights, q);
}

/* Gaps between positions keep their bytes, and so does what lies behind the last vertex. */
static void reconstruct(const pliant_asset* asset, const float* q, uint32_t columns, uint32_t first, size_t stride)
{
    unsigned char* out = fuzz_reserve(&output_area, (VERTICES - 1) * stride + 12);
    const uint32_t left = first < asset->vertex_count ? asset->vertex_count - first : 0;
    memset(out, GAP, (VERTICES - 1) * stride + 12);
    if (columns == UINT32_MAX)
        pliant_reconstruct(asset, q, first, VERTICES, (float*)(void*)out, stride);
    else
        pliant_reconstruct_columns(asset, q, columns, first, VERTICES, (float*)(void*)out, stride);
    for (uint32_t i = 0; i < VERTICES; ++i) {
        __msan_check_mem_is_initialized(out + i * stride, 12);
        for (size_t b = i < left ? 12 : 0; b < (i + 1 < VERTICES ? stride : 12); ++b) require(out[i * stride + b] == GAP);
    }
}

/* A box of numbers; without stored clusters around every position that is one. */
static void find_box(const pliant_asset* asset, const float* q)
{
    float low[3], high[3], point[3];
    require(pliant_bounds(asset, q, low, high) == PLIANT_OK);
    __msan_check_mem_is_initialized(low, sizeof low);
    __msan_check_mem_is_initialized(high, sizeof high);
    if (asset->bounds) return;
    pliant_reconstruct(asset, q, asset->vertex_count / 2, 1, point, 12);
    if (!(point[0] - point[0] == 0.0f && point[1] - point[1] == 0.0f && point[2] - point[2] == 0.0f)) return;
    for (int a = 0; a < 3; ++a) require(low[a] <= point[a] && point[a] <= high[a]);
}

static void use_coordinates(const pliant_asset* asset, const float* q, uint32_t seed)
{
    float morphs[256];
    const size_t stride = 12 + 4 * (seed % 8);
    require(pliant_morph_weights(asset, q, morphs) == (asset->morph_ranges ? PLIANT_OK : PLIANT_ERROR_ABSENT));
    if (asset->morph_ranges) __msan_check_mem_is_initialized(morphs, asset->dimension * sizeof *morphs);
    reconstruct(asset, q, UINT32_MAX, seed % 3 ? 0 : seed % asset->vertex_count, stride);
    reconstruct(asset, q, UINT32_MAX, asset->vertex_count - 1, 12);
    const uint32_t needed = pliant_columns_needed(asset, q, 1e-2f);
    require(needed <= asset->dimension);
    reconstruct(asset, q, seed % 5 ? needed : UINT32_MAX - 1, seed % 7 ? 0 : UINT32_MAX - seed % 40, stride);
    find_box(asset, q);
}

/* Positions are zero, rising or odd: what bytes steer is who is next to whom. */
static void use_normals(const pliant_asset* asset, uint32_t seed)
{
    const size_t needed = pliant_normals_memory(asset);
    const uint32_t n = asset->boundary_vertex_count, rest = n - 1;
    pliant_normals normals;
    float found[3 * VERTICES];
    if (needed > WORK_CAPACITY - 128 || 12 * (size_t)n > OUTPUT_CAPACITY - 128) return;
    float* positions = fuzz_reserve(&output_area, 12 * (size_t)n);
    void* room = fuzz_reserve(&work_area, needed);
    for (uint32_t i = 0; i < 3 * n; ++i) positions[i] = seed % 2 ? (float)(i * i % 17) : 0.0f;
    if (seed % 4 == 3) positions[seed % (3 * n)] = pick(&seed);
    const pliant_result result = pliant_normals_init(&normals, asset, room, needed);
    require((result == PLIANT_OK || result == PLIANT_ERROR_LIMIT) && normals.memory_used <= needed);
    pliant_normals_compute(&normals, positions, 12, 0, VERTICES, found, 12);
    for (uint32_t v = 0; v < n && v < VERTICES; ++v) {
        const float* a = found + 3 * v;
        require(fabsf(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - 1.0f) < 1e-3f);
    }
    pliant_normals_compute(&normals, positions, 12, rest, VERTICES, found, 12);
}

static void use_accessors(const pliant_asset* asset, size_t blob_size)
{
    pliant_weight weight;
    pliant_column column;
    for (uint32_t k = 0; k < asset->pose_count; ++k) require(strlen(pliant_asset_pose_name(asset, k)) < blob_size);
    for (uint32_t k = 0; k < asset->weight_count; ++k) {
        require(pliant_asset_weight(asset, k, &weight) == PLIANT_OK && strlen(weight.name) < blob_size);
        require(weight.low <= weight.initial && weight.initial <= weight.high);
    }
    require(pliant_asset_weight(asset, asset->weight_count, &weight) == PLIANT_ERROR_ARGUMENT);
    for (uint32_t i = 0; i < 3 * asset->triangle_count; ++i) require(asset->triangles[i] < asset->boundary_vertex_count);
    require(asset->boundary_vertex_count <= asset->vertex_count && pliant_range_unit(asset) >= 16);
    for (uint32_t j = 0; j < asset->dimension; ++j) require(pliant_asset_column(asset, j, &column) == PLIANT_OK);
    for (uint32_t v = 0; asset->source_vertices && v < asset->vertex_count; ++v)
        require(asset->source_vertices[v] < asset->vertex_count);
}

static void use_asset(const pliant_asset* asset, size_t blob_size, uint32_t seed)
{
    float q[256];
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.max_iterations = 2; /* few: the arithmetic is the slow part under sanitizers, and bytes do not steer it */
    desc.max_evaluations = 3;
    const size_t needed = pliant_solver_memory(asset, &desc);
    require(needed > 0);
    use_accessors(asset, blob_size);
    if (needed <= WORK_CAPACITY - 128) {
        void* room = fuzz_reserve(&work_area, needed);
        pliant_solver* solver;
        require(pliant_solver_init(&solver, asset, &desc, room, needed) == PLIANT_OK);
        solve_frames(asset, solver, seed, q);
        use_coordinates(asset, q, seed);
    }
    use_normals(asset, seed);
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    pliant_asset asset;
    size_t at, length;
    uint32_t seed = 0;
    if (size == 0 || size > BLOB_CAPACITY - 128) return 0;
    if (pliant_glb_find(data, size, &at, &length) == PLIANT_OK) {
        require(at <= size && length <= size - at);
        data += at;
        size = length;
    }
    if (size >= 28) memcpy(&seed, data + 24, sizeof seed); /* the checksum of the header: other bytes, other weights */
    unsigned char* blob = fuzz_reserve(&blob_area, size);
    memcpy(blob, data, size);
    const uint32_t flags = seed % 4 ? PLIANT_OPEN_DEFAULT : PLIANT_OPEN_VERIFY_CHECKSUMS;
    if (pliant_asset_open(&asset, blob, size, flags) == PLIANT_OK) use_asset(&asset, size, seed);
    return 0;
}
