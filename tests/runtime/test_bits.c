/* Prints a hash of some hundred blends and shapes of every asset: compare_bits.py wants the same from builds for other
   instruction sets and optimisation levels. */
#include "support.h"

static uint64_t bits = 14695981039346656037ull;

static void add(const float* values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        uint32_t word;
        memcpy(&word, &values[i], sizeof word);
        bits = (bits ^ word) * 1099511628211ull;
    }
}

static void add_asset(const opened* o)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    uint64_t state = 61;
    float weights[64], q[256];
    const uint32_t n = o->asset.vertex_count;
    const size_t size = pliant_normals_memory(&o->asset);
    float* positions = malloc((size_t)n * 24);
    void* memory = malloc(size);
    pliant_normals normals;
    if (!positions || !memory || pliant_normals_init(&normals, &o->asset, memory, size) != PLIANT_OK) exit(2);
    for (int frame = 0; frame < 30; ++frame) {
        pliant_solve_info info;
        if (frame % 6 == 0) random_blend(&state, &o->asset, weights);
        weights[frame % (int)o->asset.weight_count] += 0.03f;
        CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s", o->name);
        pliant_reconstruct(&o->asset, q, 0, n, positions, 12);
        pliant_normals_compute(&normals, positions, 12, 0, n, positions + 3 * (size_t)n, 12);
        add(q, o->asset.dimension);
        add(&info.energy, 1);
        add(positions, 24);
        add(positions + 3 * (size_t)n, 3 * (size_t)o->asset.boundary_vertex_count);
    }
    free(made.memory);
    free(memory);
    free(positions);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
#if defined(__AVX2__) && defined(__GNUC__)
    if (!__builtin_cpu_supports("avx2")) {
        printf("skipped: this processor has no AVX2\n");
        return 77;
    }
#endif
    for_each_asset(argv[1], add_asset);
    printf("bits %016llx\n", (unsigned long long)bits);
    return failure_count != 0;
}
