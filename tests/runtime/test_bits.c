/* test_bits FOLDER...: prints hashes of blends of every asset in FOLDER/assets.txt. Builds for other compilers, instruction
   sets, optimisation levels and systems must print the same (compare_bits.py, tests/platforms); for tests/golden it is
   blends.txt there, whose README describes a line. */
#include "support.h"

#define START 14695981039346656037ull

static uint64_t hashed(uint64_t hash, const float* values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        uint32_t word;
        memcpy(&word, &values[i], sizeof word);
        hash = (hash ^ word) * 1099511628211ull;
    }
    return hash;
}

typedef struct character {
    const opened* o;
    made_solver made;
    pliant_normals normals;
    void* normals_memory;
    float q[256];
    pliant_solve_info info;
    float* positions; /* of all vertices, and behind them the normals */
} character;

static void pose(character* c, const float* weights)
{
    const pliant_asset* asset = &c->o->asset;
    CHECK(pliant_solve(c->made.solver, weights, c->q, &c->info) == PLIANT_OK, "%s", c->o->name);
    pliant_reconstruct(asset, c->q, 0, asset->vertex_count, c->positions, 12);
    pliant_normals_compute(&c->normals, c->positions, 12, 0, asset->boundary_vertex_count,
                           c->positions + 3 * (size_t)asset->vertex_count, 12);
}

/* A blend by a solver without history. */
static void print_blend(character* c, const float* first_weights, uint32_t first_count)
{
    const pliant_asset* asset = &c->o->asset;
    const size_t count = 3 * (size_t)asset->boundary_vertex_count;
    float weights[64] = { 0.0f };
    printf("%s ", c->o->name);
    for (uint32_t k = 0; k < first_count && k < asset->weight_count; ++k) {
        weights[k] = first_weights[k];
        printf(k ? ",%g" : "%g", (double)weights[k]);
    }
    pliant_solver_reset(c->made.solver);
    pose(c, weights);
    printf(" %016llx %016llx\n", (unsigned long long)hashed(START, c->positions, count),
           (unsigned long long)hashed(START, c->positions + 3 * (size_t)asset->vertex_count, count));
}

/* Jumps and drags of one solver. */
static void print_walk(character* c)
{
    const pliant_asset* asset = &c->o->asset;
    uint64_t state = 61, hash = START;
    float weights[64];
    pliant_solver_reset(c->made.solver);
    for (int frame = 0; frame < 30; ++frame) {
        if (frame % 6 == 0) random_blend(&state, asset, weights);
        weights[frame % (int)asset->weight_count] += 0.03f;
        pose(c, weights);
        hash = hashed(hash, c->q, asset->dimension);
        hash = hashed(hash, &c->info.energy, 1);
        hash = hashed(hash, c->positions, 24);
        hash = hashed(hash, c->positions + 3 * (size_t)asset->vertex_count, 3 * (size_t)asset->boundary_vertex_count);
    }
    printf("%s walk %016llx\n", c->o->name, (unsigned long long)hash);
}

static void print_asset(const opened* o)
{
    static const float one[] = { 1.0f }, equal[] = { 0.5f, 0.5f, 0.5f }, mixed[] = { 0.25f, 0.5f, 0.75f };
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const size_t size = pliant_normals_memory(&o->asset);
    character c = { .o = o, .made = make_solver(&o->asset, &desc) };
    c.positions = malloc((size_t)o->asset.vertex_count * 24);
    c.normals_memory = malloc(size);
    if (!c.positions || !c.normals_memory || pliant_normals_init(&c.normals, &o->asset, c.normals_memory, size) != PLIANT_OK)
        exit(2);
    print_blend(&c, one, 1);
    print_blend(&c, equal, 3);
    print_blend(&c, mixed, 3);
    print_walk(&c);
    free(c.made.memory);
    free(c.normals_memory);
    free(c.positions);
}

int main(int argc, char** argv)
{
    if (argc < 2) return 2;
#if defined(__AVX2__) && defined(__GNUC__)
    if (!__builtin_cpu_supports("avx2")) {
        printf("skipped: this processor has no AVX2\n");
        return 77;
    }
#endif
    for (int i = 1; i < argc; ++i) for_each_asset(argv[i], print_asset);
    return failure_count != 0;
}
