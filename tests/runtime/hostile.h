/* Bytes that a test does not trust, placed read-only against a page that must not be touched, and driven through every call
   that takes an asset. A read past the end or a write into the blob ends the process. */
#ifndef PLIANT_TEST_HOSTILE_H
#define PLIANT_TEST_HOSTILE_H

#ifndef _DEFAULT_SOURCE
#define _DEFAULT_SOURCE /* mmap */
#endif
#include "support.h"

#include <sys/mman.h>
#include <unistd.h>

typedef struct cage {
    unsigned char* pages;
    size_t room; /* bytes before the guard page */
} cage;

static inline cage make_cage(size_t largest)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    cage c = { NULL, (largest + 16 + page - 1) / page * page };
    c.pages = mmap(NULL, c.room + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (c.pages == MAP_FAILED || mprotect(c.pages + c.room, page, PROT_NONE) != 0) exit(2);
    return c;
}

/* The blob's end lies as near to the guard page as the alignment of 16 at its start allows; the bytes between, which do not
   belong to it, are 0xEE. */
static inline const unsigned char* cage_blob(cage* c, const unsigned char* bytes, size_t size)
{
    if (mprotect(c->pages, c->room, PROT_READ | PROT_WRITE) != 0) exit(2);
    unsigned char* start = c->pages + (c->room - size) / 16 * 16;
    memset(start, 0xEE, (size_t)(c->pages + c->room - start));
    memcpy(start, bytes, size);
    if (mprotect(c->pages, c->room, PROT_READ) != 0) exit(2);
    return start;
}

/* Opens, and if that works solves three frames and rebuilds everything. Memory of a hostile asset's solver is capped: what a
   host would refuse to allocate is not this library's affair. */
static inline pliant_result exercise(const unsigned char* bytes, size_t size)
{
    pliant_asset asset;
    const pliant_result result = pliant_asset_open(&asset, bytes, size, PLIANT_OPEN_DEFAULT);
    if (result != PLIANT_OK) {
        const pliant_asset nothing = { 0 };
        CHECK(memcmp(&asset, &nothing, sizeof asset) == 0, "a refused asset leaves something behind");
        return result;
    }
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.max_iterations = 8;
    const size_t needed = pliant_solver_memory(&asset, &desc);
    CHECK(needed > 0, "an open asset has no solver size");
    void* memory = needed <= (64u << 20) ? malloc(needed) : NULL;
    pliant_solver* solver = NULL;
    if (memory && pliant_solver_init(&solver, &asset, &desc, memory, needed) == PLIANT_OK) {
        float weights[64], q[256], positions[48 * 3];
        for (int frame = 0; frame < 3; ++frame) {
            for (uint32_t k = 0; k < asset.weight_count; ++k)
                weights[k] = frame == 2 ? (float)(k == 0) : 1.0f + (float)(k * (uint32_t)frame);
            CHECK(pliant_solve(solver, weights, q, NULL) == PLIANT_OK, "a frame of an open asset");
            for (uint32_t j = 0; j < asset.dimension; ++j) CHECK(q[j] - q[j] == 0.0f, "q is not finite");
        }
        for (uint32_t v = 0; v < asset.vertex_count && v < 65536; v += 40)
            pliant_reconstruct(&asset, q, v, 40, positions, 12);
        pliant_reconstruct(&asset, q, asset.vertex_count - 1, 40, positions, 12);
        pliant_reconstruct_columns(&asset, q, pliant_columns_needed(&asset, q, 1e-2f), 0, 40, positions, 12);
        CHECK(pliant_bounds(&asset, q, positions, positions + 3) == PLIANT_OK, "bounds of an open asset");
    }
    for (uint32_t k = 0; k < asset.pose_count; ++k) {
        const char* name = pliant_asset_pose_name(&asset, k);
        CHECK(name && strlen(name) < size, "pose name %u", k);
        CHECK(pliant_asset_pose_coordinates(&asset, k) != NULL, "pose %u", k);
    }
    for (uint32_t k = 0; k < asset.weight_count; ++k) {
        pliant_weight weight;
        CHECK(pliant_asset_weight(&asset, k, &weight) == PLIANT_OK && strlen(weight.name) < size, "weight %u", k);
        CHECK(weight.low <= weight.initial && weight.initial <= weight.high, "range of weight %u", k);
    }
    for (uint32_t i = 0; i < 3 * asset.triangle_count; ++i)
        CHECK(asset.triangles[i] < asset.boundary_vertex_count, "a triangle");
    pliant_column column;
    for (uint32_t j = 0; j < asset.dimension; ++j)
        CHECK(pliant_asset_column(&asset, j, &column) == PLIANT_OK, "column %u", j);
    CHECK(asset.boundary_vertex_count >= 1 && asset.boundary_vertex_count <= asset.vertex_count, "the boundary");
    for (uint32_t v = 0; asset.source_vertices && v < asset.vertex_count; ++v)
        CHECK(asset.source_vertices[v] < asset.vertex_count, "a vertex of the input");
    free(memory);
    return PLIANT_OK;
}

#endif
