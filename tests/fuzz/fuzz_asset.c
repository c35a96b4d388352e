/* libFuzzer target: any bytes through open, two frames (the second continues the first), reconstruction, normals and the
   small accessors. Checksums are not verified here: a checksum would hide every bug behind it, and a hostile file has the
   right one. */
#include "pliant.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed);

/* What a host would refuse to allocate is not the library's affair. */
#define LARGEST_SOLVER ((size_t)16 << 20)

static void require(int condition)
{
    if (!condition) abort();
}

static void solve_frames(const pliant_asset* asset, pliant_solver* solver)
{
    float weights[64], q[256], positions[3 * 48];
    for (uint32_t frame = 0; frame < 2; ++frame) {
        pliant_solve_info info;
        for (uint32_t k = 0; k < asset->weight_count; ++k) weights[k] = 1.0f + 0.01f * (float)(k * frame);
        require(pliant_solve(solver, weights, q, &info) == PLIANT_OK);
        require(info.evaluations <= 3);
        for (uint32_t j = 0; j < asset->dimension; ++j) require(q[j] - q[j] == 0.0f);
    }
    require(pliant_morph_weights(asset, q, q) == (asset->morph_ranges ? PLIANT_OK : PLIANT_ERROR_ABSENT));
    pliant_reconstruct(asset, q, 0, 48, positions, 12);
    pliant_reconstruct(asset, q, asset->vertex_count - 1, 48, positions, 12);
    pliant_reconstruct_columns(asset, q, pliant_columns_needed(asset, q, 1e-2f), 0, 48, positions, 12);
    require(pliant_bounds(asset, q, positions, positions + 3) == PLIANT_OK);
}

/* Positions are all zero: what bytes steer is who is next to whom. */
static void use_normals(const pliant_asset* asset)
{
    const size_t needed = pliant_normals_memory(asset);
    const uint32_t n = asset->boundary_vertex_count;
    float* positions = calloc(n, 12);
    void* memory = malloc(needed);
    float found[3 * 48];
    pliant_normals normals;
    require(positions && memory && pliant_normals_init(&normals, asset, memory, needed) == PLIANT_OK);
    require(normals.memory_used <= needed);
    pliant_normals_compute(&normals, positions, 12, 0, 48, found, 12);
    pliant_normals_compute(&normals, positions, 12, n - 1, 48, found, 12);
    free(memory);
    free(positions);
}

static void use_asset(const pliant_asset* asset, size_t blob_size)
{
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.max_iterations = 2; /* few: the arithmetic is the slow part under sanitizers, and bytes do not steer it */
    desc.max_evaluations = 3;
    const size_t needed = pliant_solver_memory(asset, &desc);
    require(needed > 0);
    if (needed <= LARGEST_SOLVER) {
        void* memory = malloc(needed);
        pliant_solver* solver;
        require(memory && pliant_solver_init(&solver, asset, &desc, memory, needed) == PLIANT_OK);
        solve_frames(asset, solver);
        free(memory);
    }
    use_normals(asset);
    for (uint32_t k = 0; k < asset->pose_count; ++k) require(strlen(pliant_asset_pose_name(asset, k)) < blob_size);
    pliant_weight weight;
    for (uint32_t k = 0; k < asset->weight_count; ++k) {
        require(pliant_asset_weight(asset, k, &weight) == PLIANT_OK && strlen(weight.name) < blob_size);
        require(weight.low <= weight.initial && weight.initial <= weight.high);
    }
    for (uint32_t i = 0; i < 3 * asset->triangle_count; ++i) require(asset->triangles[i] < asset->boundary_vertex_count);
    require(asset->boundary_vertex_count <= asset->vertex_count);
    pliant_column column;
    for (uint32_t j = 0; j < asset->dimension; ++j) require(pliant_asset_column(asset, j, &column) == PLIANT_OK);
    for (uint32_t v = 0; asset->source_vertices && v < asset->vertex_count; ++v)
        require(asset->source_vertices[v] < asset->vertex_count);
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    /* A copy of exactly this size: AddressSanitizer sees the first byte past it. */
    void* blob = NULL;
    pliant_asset asset;
    if (size == 0 || posix_memalign(&blob, 64, size) != 0) return 0;
    memcpy(blob, data, size);
    if (pliant_asset_open(&asset, blob, size, PLIANT_OPEN_DEFAULT) == PLIANT_OK) use_asset(&asset, size);
    free(blob);
    return 0;
}

/* Mutates, then mostly states the new size in the header: otherwise nearly every input would stop at rule R04. */
size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed)
{
    const size_t mutated = LLVMFuzzerMutate(data, size, max_size);
    const uint64_t stated = mutated;
    if (mutated >= 24 && seed % 16 != 0) memcpy(data + 16, &stated, sizeof stated);
    return mutated;
}
