/* Measures one evaluation of the surrogate energy, start and load, and one reconstruction on synthetic data of chosen size;
   asserts nothing.
       bench_evaluate [d=64] [hinges=160] [faces=160] [poses=5] [vertices=20000] [centres=100]
   Prints a hash of the results: builds for other instruction sets must print the same one. */
#define _POSIX_C_SOURCE 199309L
#include "internal.h"
#include "linalg.h"
#include "support.h"

#include <math.h>
#include <time.h>

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static float* fill(size_t count, float centre, float size, uint64_t* state)
{
    float* values = malloc(count * sizeof *values + 64);
    if (!values) exit(2);
    values += (64 - (uintptr_t)values % 64) % 64 / sizeof *values;
    for (size_t i = 0; i < count; ++i) values[i] = centre + size * (random_unit(state) - 0.5f);
    return values;
}

/* Difference vectors near those of a regular pair of triangles, and small columns: valid hinges and faces. */
static void fill_batch(unsigned char* chunk, pliant_format_batch* batch, uint32_t kind, uint32_t count, uint32_t d,
                       uint32_t m, uint64_t* at, uint64_t* state)
{
    static const float hinge[9] = { 1, 0, 0, 0.5f, 0.8f, 0.1f, 0.5f, -0.8f, 0.1f };
    const pliant_format_shape shape = pliant_format_batch_shape(kind, 0, 0);
    const size_t lanes = pliant_pad_lanes(count);
    memset(batch, 0, sizeof *batch);
    batch->kind = kind;
    batch->element_count = count;
    batch->rows_offset = *at;
    float* rows = (float*)(void*)(chunk + *at);
    for (size_t j = 0; j <= d; ++j)
        for (size_t r = 0; r < shape.row_count; ++r)
            for (size_t l = 0; l < lanes; ++l)
                *rows++ = (j == 0 ? hinge[r] : 0.0f) + (j == 0 ? 0.1f : 0.05f) * (random_unit(state) - 0.5f);
    *at += (1 + (uint64_t)d) * shape.row_count * lanes * sizeof(float);
    batch->fixed_offset = *at;
    float* fixed = (float*)(void*)(chunk + *at);
    for (size_t i = 0; i < shape.fixed_count * lanes; ++i) fixed[i] = kind == 2 && i / lanes != 1 ? 1.5f : 0.0f;
    *at += shape.fixed_count * lanes * sizeof(float);
    batch->pose_offset = *at;
    float* numbers = (float*)(void*)(chunk + *at);
    for (size_t i = 0; i < m * shape.pose_number_count * lanes; ++i) numbers[i] = 0.1f + random_unit(state);
    *at += m * shape.pose_number_count * lanes * sizeof(float);
}

static uint64_t hash(const void* bytes, size_t size, uint64_t seed)
{
    const unsigned char* p = (const unsigned char*)bytes;
    for (size_t i = 0; i < size; ++i) seed = (seed ^ p[i]) * 1099511628211ull;
    return seed;
}

static uint64_t bench_evaluation(pliant_asset* asset, uint32_t hinges, uint32_t faces, uint64_t* state)
{
    const uint32_t d = asset->dimension, m = asset->pose_count;
    static pliant_format_batch batches[2];
    uint64_t at = 0;
    const size_t size = ((1 + (size_t)d) * (9 * pliant_pad_lanes(hinges) + 6 * pliant_pad_lanes(faces))
                         + (4 + 9 * (size_t)m) * (pliant_pad_lanes(hinges) + pliant_pad_lanes(faces)))
        * sizeof(float);
    unsigned char* chunk = (unsigned char*)fill(size / sizeof(float), 0.0f, 0.0f, state);
    fill_batch(chunk, &batches[0], PLIANT_ELEMENT_HINGE, hinges, d, m, &at, state);
    fill_batch(chunk, &batches[1], PLIANT_ELEMENT_FACE_NEO_HOOKEAN, faces, d, m, &at, state);
    asset->batches = batches;
    asset->batch_count = 2;
    asset->elements = chunk;
    const pliant_kernels* kernels = pliant_kernels_choose();
    const pliant_energy_layout layout = pliant_elements_measure(asset);
    float* combined = fill(layout.combined_floats, 0.0f, 0.0f, state);
    float* scratch = fill(layout.scratch_floats, 0.0f, 0.0f, state);
    float* z = fill(asset->padded_dimension, 0.0f, 0.2f, state);
    float* gradient = fill(asset->padded_dimension, 0.0f, 0.0f, state);
    float* weights = fill(m, 1.0f / (float)m, 0.0f, state);
    double best_combine = 1.0, best = 1.0, energy = 0.0;
    for (int round = 0; round < 2000; ++round) {
        const double t0 = now();
        pliant_elements_combine(kernels, asset, weights, combined);
        const double t1 = now();
        energy = pliant_elements_evaluate(kernels, asset, weights, combined, z, gradient, scratch);
        const double t2 = now();
        if (t1 - t0 < best_combine) best_combine = t1 - t0;
        if (t2 - t1 < best) best = t2 - t1;
    }
    printf("combine %.2f us, value and gradient %.2f us (%.0f KiB of rows)\n", 1e6 * best_combine, 1e6 * best,
           (double)size / 1024.0);
    return hash(gradient, d * sizeof(float), hash(&energy, sizeof energy, 14695981039346656037ull));
}

static uint64_t bench_radial(pliant_asset* asset, uint64_t* state)
{
    const size_t d = asset->padded_dimension, m = asset->pose_count, rows = asset->predictor_count + m;
    float* weights = fill(m, 1.0f / (float)m, 0.0f, state);
    float* start = fill(d, 0.0f, 0.0f, state);
    float* load = fill(d, 0.0f, 0.0f, state);
    float* scratch = fill(pliant_radial_floats(asset), 0.0f, 0.0f, state);
    double best = 1.0;
    asset->predictor_centres = fill(asset->predictor_count * m, 0.5f, 1.0f, state);
    asset->predictor_coefficients = fill(rows * d, 0.0f, 1.0f, state);
    asset->load_coefficients = fill(rows * d, 0.0f, 1.0f, state);
    for (int round = 0; round < 2000; ++round) {
        const double t0 = now();
        pliant_radial_evaluate(pliant_kernels_choose(), asset, weights, scratch, start, load);
        const double t1 = now();
        if (t1 - t0 < best) best = t1 - t0;
    }
    printf("start and load %.2f us (%u centres)\n", 1e6 * best, asset->predictor_count);
    return hash(load, d * sizeof(float), hash(start, d * sizeof(float), 14695981039346656037ull));
}

static uint64_t bench_reconstruction(pliant_asset* asset, uint64_t* state)
{
    const size_t tiles = (asset->vertex_count + 15) / 16;
    float* positions = fill(3 * (size_t)asset->vertex_count, 0.0f, 0.0f, state);
    float* q = fill(asset->dimension, 0.0f, 2.0f, state);
    double best = 1.0;
    asset->rest = fill(tiles * 48, 0.0f, 2.0f, state);
    asset->basis = fill(tiles * 48 * asset->dimension, 0.0f, 0.1f, state);
    for (int round = 0; round < 50; ++round) {
        const double start = now();
        pliant_reconstruct(asset, q, 0, asset->vertex_count, positions, 12);
        const double time = now() - start;
        if (time < best) best = time;
    }
    const double bytes = (double)tiles * 192.0 * (1.0 + (double)asset->dimension);
    printf("reconstruct %.3f ms (%.1f MiB of basis, %.1f GB/s)\n", 1e3 * best, bytes / 1048576.0, 1e-9 * bytes / best);
    return hash(positions, 12 * (size_t)asset->vertex_count, 14695981039346656037ull);
}

int main(int argc, char** argv)
{
    uint32_t numbers[6] = { 64, 160, 160, 5, 20000, 100 };
    for (int i = 1; i < argc && i <= 6; ++i) numbers[i - 1] = (uint32_t)strtoul(argv[i], NULL, 10);
    pliant_asset asset;
    uint64_t state = 1;
    memset(&asset, 0, sizeof asset);
    asset.kernels = pliant_kernels_choose();
    asset.dimension = numbers[0];
    asset.padded_dimension = (uint32_t)pliant_pad_lanes(numbers[0]);
    asset.pose_count = numbers[3];
    asset.vertex_count = numbers[4];
    asset.predictor_count = numbers[5];
    asset.energy_scale = 1.0f;
    printf("d %u, %u hinges, %u faces, %u poses, %u vertices\n", numbers[0], numbers[1], numbers[2], numbers[3], numbers[4]);
    uint64_t bits = bench_evaluation(&asset, numbers[1], numbers[2], &state);
    bits ^= bench_radial(&asset, &state);
    bits ^= bench_reconstruction(&asset, &state);
    printf("bits %016llx\n", (unsigned long long)bits);
    return 0;
}
