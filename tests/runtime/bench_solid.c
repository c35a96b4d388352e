/* Measures what solids cost on synthetic data: tetrahedra of both kinds, the quartic polynomial, combining; medians, with
   the processor's kernels and with the plain ones; asserts nothing.
       bench_solid [d=32] [tetrahedra=320] [poses=5]
   Prints a hash of the results: both sets of kernels and builds for other instruction sets must print the same one. */
#define _POSIX_C_SOURCE 199309L
#include "internal.h"
#include "support.h"

#include <time.h>

enum { ROUNDS = 3001 };

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

static int compare(const void* a, const void* b)
{
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

static double median_us(double* times)
{
    qsort(times, ROUNDS, sizeof *times, compare);
    return 1e6 * times[ROUNDS / 2];
}

/* Combining and evaluating with one set of kernels. */
static uint64_t measure(const char* what, const pliant_kernels* kernels, const pliant_asset* asset, const float* weights,
                        const float* z)
{
    static double combining[ROUNDS], evaluating[ROUNDS];
    uint64_t state = 5, bits = 14695981039346656037ull;
    const pliant_energy_layout layout = asset->quartic ? pliant_quartic_measure(asset) : pliant_elements_measure(asset);
    float* combined = fill(layout.combined_floats, 0.0f, 0.0f, &state);
    float* scratch = fill(layout.scratch_floats, 0.0f, 0.0f, &state);
    float* gradient = fill(asset->padded_dimension, 0.0f, 0.0f, &state);
    double energy = 0.0;
    for (int round = 0; round < ROUNDS; ++round) {
        const double t0 = now();
        if (asset->quartic)
            pliant_quartic_combine(kernels, asset, weights, combined);
        else
            pliant_elements_combine(kernels, asset, weights, combined);
        const double t1 = now();
        combining[round] = t1 - t0;
    }
    for (int round = 0; round < ROUNDS; ++round) {
        const double t0 = now();
        energy = asset->quartic ? pliant_quartic_evaluate(kernels, asset, combined, z, gradient, scratch)
                                : pliant_elements_evaluate(kernels, asset, weights, combined, z, gradient, scratch);
        const double t1 = now();
        evaluating[round] = t1 - t0;
    }
    for (uint32_t j = 0; j < asset->dimension; ++j) {
        uint32_t word;
        memcpy(&word, &gradient[j], sizeof word);
        bits = (bits ^ word) * 1099511628211ull;
    }
    printf("%-14s %-9s combine %7.2f us, value and gradient %7.2f us, value %.9g, bits %016llx\n", what,
           kernels == &pliant_kernels_plain ? "plain" : "processor", median_us(combining), median_us(evaluating), energy,
           (unsigned long long)bits);
    return bits;
}

static void measure_both(const char* what, const pliant_asset* asset, const float* weights, const float* z)
{
    const uint64_t plain = measure(what, &pliant_kernels_plain, asset, weights, z);
    if (measure(what, pliant_kernels_choose(), asset, weights, z) != plain) printf("DIFFERENT BITS\n");
}

/* Gradients of deformation near the identity. */
static void fill_tetrahedra(pliant_asset* asset, pliant_format_batch* batch, uint32_t kind, uint32_t count, uint64_t* state)
{
    const pliant_format_shape shape = pliant_format_batch_shape(kind, 0, 0);
    const size_t lanes = pliant_pad_lanes(count), rows = (1 + (size_t)asset->dimension) * shape.row_count * lanes;
    float* floats = fill(rows + (size_t)asset->pose_count * shape.pose_number_count * lanes, 0.0f, 0.05f, state);
    for (size_t i = 0; i < 9 * lanes; ++i) floats[i] = i / lanes % 4 == 0 ? 1.0f : 0.0f;
    memset(batch, 0, sizeof *batch);
    batch->kind = kind;
    batch->element_count = count;
    batch->fixed_offset = batch->pose_offset = rows * sizeof(float);
    asset->batches = batch;
    asset->batch_count = 1;
    asset->elements = (const unsigned char*)floats;
}

int main(int argc, char** argv)
{
    uint32_t numbers[3] = { 32, 320, 5 };
    for (int i = 1; i < argc && i <= 3; ++i) numbers[i - 1] = (uint32_t)strtoul(argv[i], NULL, 10);
    pliant_asset asset;
    pliant_format_batch batch;
    uint64_t state = 1;
    memset(&asset, 0, sizeof asset);
    asset.kernels = pliant_kernels_choose();
    asset.dimension = numbers[0];
    asset.padded_dimension = (uint32_t)pliant_pad_lanes(numbers[0]);
    asset.pose_count = numbers[2];
    const float* weights = fill(numbers[2], 1.0f / (float)numbers[2], 0.0f, &state);
    const float* z = fill(asset.padded_dimension, 0.0f, 0.2f, &state);
    printf("d %u, %u tetrahedra, %u poses\n", numbers[0], numbers[1], numbers[2]);
    fill_tetrahedra(&asset, &batch, PLIANT_ELEMENT_TET_STVK, numbers[1], &state);
    measure_both("StVK", &asset, weights, z);
    fill_tetrahedra(&asset, &batch, PLIANT_ELEMENT_TET_MOONEY_RIVLIN, numbers[1], &state);
    measure_both("Mooney-Rivlin", &asset, weights, z);
    if (numbers[0] > PLIANT_FORMAT_MAX_QUARTIC_DIMENSION) return 0;
    asset.quartic_floats = pliant_pad_lanes((size_t)pliant_format_quartic_floats(numbers[0]));
    asset.quartic = fill(asset.quartic_floats * numbers[2], 0.0f, 1.0f, &state);
    printf("quartic: %.0f KiB a pose\n", (double)asset.quartic_floats / 256.0);
    measure_both("quartic", &asset, weights, z);
    return 0;
}
