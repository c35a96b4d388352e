/* The solver's memory: exactly what pliant_solver_memory says, at any alignment, nothing outside it, and no allocation in
   10,000 frames. Linked with --wrap for malloc, calloc, realloc and free. */
#include "allocations.h"
#include "support.h"

enum { GUARD = 256, GUARD_BYTE = 0xA5 };

static int guards_are_intact(const unsigned char* memory, size_t offset, size_t size)
{
    for (size_t i = 0; i < offset + GUARD; ++i)
        if (memory[i] != GUARD_BYTE) return 0;
    for (size_t i = 0; i < GUARD; ++i)
        if (memory[offset + GUARD + size + i] != GUARD_BYTE) return 0;
    return 1;
}

/* A drag with a jump now and then. */
static void step_weights(uint64_t* state, const pliant_asset* asset, int frame, float* weights)
{
    if (frame % 50 == 0) random_blend(state, asset, weights);
    for (uint32_t k = 0; k < asset->weight_count; ++k) {
        weights[k] += 0.02f * (random_unit(state) - 0.5f);
        if (weights[k] < 0.0f && !asset->has_layers) weights[k] = 0.0f;
    }
    weights[0] += 1e-6f;
}

/* ARAP costs a hundred times a hinge. */
static int is_slow(const opened* o) { return strstr(o->name, "arap") || strstr(o->name, "mixed"); }

static void check_alignments(const opened* o)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const size_t size = pliant_solver_memory(&o->asset, &desc);
    unsigned char* memory = malloc(size + 64 + 2 * GUARD + 64);
    float weights[64], q[256], first_q[256];
    if (!memory) exit(2);
    CHECK(size > 0, "%s: no size", o->name);
    for (size_t alignment = 0; alignment < 64; alignment += is_slow(o) ? 7 : 1) {
        uint64_t state = 3;
        const size_t offset = alignment + (64 - (uintptr_t)memory % 64) % 64;
        unsigned char* start = memory + GUARD + offset;
        pliant_solver* solver = NULL;
        memset(memory, GUARD_BYTE, size + 64 + 2 * GUARD + 64);
        CHECK(pliant_solver_init(&solver, &o->asset, &desc, start, size - 1) == PLIANT_ERROR_MEMORY_SIZE && !solver,
              "%s: one byte less was taken", o->name);
        CHECK(pliant_solver_init(&solver, &o->asset, &desc, start, size) == PLIANT_OK, "%s: the size asked for", o->name);
        for (int frame = 0; frame < 5; ++frame) {
            step_weights(&state, &o->asset, frame, weights);
            CHECK(pliant_solve(solver, weights, q, NULL) == PLIANT_OK, "%s", o->name);
        }
        CHECK(guards_are_intact(memory, offset, size), "%s: wrote outside its memory at alignment %zu", o->name, alignment);
        if (alignment == 0) memcpy(first_q, q, sizeof q);
        CHECK(memcmp(q, first_q, o->asset.dimension * sizeof(float)) == 0, "%s: alignment changes the answer", o->name);
    }
    free(memory);
}

static void check_frames(const opened* o)
{
    const int frames = (is_slow(o) ? 1000 : 10000) / SLOWNESS;
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    float weights[64], q[256], positions[48];
    uint64_t state = 5;
    long unconverged = 0;
    const long before = allocation_count;
    for (int frame = 0; frame < frames; ++frame) {
        pliant_solve_info info;
        step_weights(&state, &o->asset, frame, weights);
        CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s: frame %d", o->name, frame);
        pliant_reconstruct(&o->asset, q, 0, 16, positions, 12);
        unconverged += info.status != PLIANT_STATUS_CONVERGED;
        for (uint32_t j = 0; j < o->asset.dimension; ++j) CHECK(q[j] - q[j] == 0.0f, "%s: frame %d", o->name, frame);
    }
    CHECK(allocation_count == before, "%s: %ld calls of the allocator", o->name, allocation_count - before);
    CHECK(unconverged * 100 <= frames, "%s: %ld of %d frames did not converge", o->name, unconverged, frames);
    printf("%s: %d frames, %ld unconverged\n", o->name, frames, unconverged);
    free(made.memory);
}

static void check_bad_arguments(const opened* o)
{
    pliant_solver_desc desc = pliant_solver_desc_default();
    pliant_solver* solver = NULL;
    const pliant_asset closed = { 0 };
    unsigned char poisoned[4096];
    float weights[64] = { 1.0f }, q[256];
    CHECK(pliant_solver_memory(NULL, &desc) == 0, "no asset");
    CHECK(pliant_solver_memory(&o->asset, NULL) == 0, "no desc");
    CHECK(pliant_solver_memory(&closed, &desc) == 0, "an asset that did not open");
    CHECK(pliant_solver_init(NULL, &o->asset, &desc, poisoned, sizeof poisoned) == PLIANT_ERROR_ARGUMENT, "no out");
    CHECK(pliant_solver_init(&solver, &o->asset, &desc, NULL, 1u << 30) == PLIANT_ERROR_ARGUMENT, "no memory");
    desc.struct_size -= 4;
    CHECK(pliant_solver_memory(&o->asset, &desc) == 0, "a desc of another version");
    desc = pliant_solver_desc_default();
    desc.max_evaluations = 0;
    CHECK(pliant_solver_memory(&o->asset, &desc) == 0, "no evaluation at all");
    desc = pliant_solver_desc_default();
    desc.tolerance = 0.0f / (desc.continuity - desc.continuity);
    CHECK(pliant_solver_memory(&o->asset, &desc) == 0, "tolerance is not a number");
    memset(poisoned, 0xFF, sizeof poisoned);
    CHECK(pliant_solve((pliant_solver*)(void*)poisoned, weights, q, NULL) == PLIANT_ERROR_ARGUMENT, "memory of no solver");
    CHECK(pliant_solve(NULL, weights, q, NULL) == PLIANT_ERROR_ARGUMENT, "no solver");
    pliant_solver_reset(NULL);
}

static void check_asset(const opened* o)
{
    check_alignments(o);
    check_frames(o);
    check_bad_arguments(o);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_asset);
    CHECK(allocation_count > 0, "the wrapper counts nothing: this test is not linked as it should be");
    return report("memory");
}
