/* What a frame costs beside linear morph targets of the same poses.
       pliant_bench_frame ASSET... [--frames N]
   A line per asset: microseconds to solve and to rebuild all vertices on a slow drag through the weights, those of the first
   pose plus the weighted differences of the others in single precision, and the bytes that either reads. Medians of N frames
   (default 2,000), both in turns, on one core. The linear sum is compiled for this processor and with -ffast-math. The first
   asset is also compared with the others of as many vertices: the farthest vertex at the last frame, in units of the input.
   Asserts nothing. */
#define _POSIX_C_SOURCE 199309L
#include "../../formats/pliant_format.h"
#include "../runtime/support.h"

#include <math.h>
#include <time.h>

enum { max_assets = 16, max_poses = 64, max_dimension = 256 };

typedef struct measured {
    blob_file blob;
    pliant_asset asset;
    made_solver solver;
    float *positions, *targets, *blended; /* targets: the first pose, then differences */
    double *solve, *rebuild, *linear;
} measured;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int compare(const void* a, const void* b)
{
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

static double median(double* values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare);
    return values[count / 2];
}

static void* allocate(size_t size)
{
    void* memory = calloc(1, size);
    if (!memory) exit(2);
    return memory;
}

static int open_measured(measured* m, const char* path, int frames)
{
    m->blob = read_blob(path);
    const pliant_result result = pliant_asset_open(&m->asset, m->blob.data, m->blob.size, PLIANT_OPEN_DEFAULT);
    if (result != PLIANT_OK) {
        fprintf(stderr, "%s: %s\n", path, pliant_result_text(result));
        return 0;
    }
    const size_t floats = 3 * (size_t)m->asset.vertex_count, times = (size_t)frames * sizeof(double);
    m->solver = make_solver(&m->asset, NULL);
    m->positions = allocate(floats * sizeof(float));
    m->blended = allocate(floats * sizeof(float));
    m->targets = allocate(floats * m->asset.pose_count * sizeof(float));
    m->solve = allocate(times);
    m->rebuild = allocate(times);
    m->linear = allocate(times);
    for (uint32_t k = 0; k < m->asset.pose_count; ++k) {
        float* target = m->targets + floats * k;
        pliant_reconstruct(&m->asset, pliant_asset_pose_coordinates(&m->asset, k), 0, m->asset.vertex_count, target, 12);
        for (size_t i = 0; k > 0 && i < floats; ++i) target[i] -= m->targets[i];
    }
    return 1;
}

/* Saw teeth of different lengths: all poses take part, and weights move by some thousandths a frame. */
static void weights_of(int frame, uint32_t count, float* weights)
{
    float sum = 0.0f;
    for (uint32_t k = 0; k < count; ++k) {
        const float place = 0.002f * (float)frame * (1.0f + 0.37f * (float)k) + 0.21f * (float)k,
                    part = place - floorf(place);
        weights[k] = 0.01f + (part < 0.5f ? 2.0f * part : 2.0f - 2.0f * part);
        sum += weights[k];
    }
    for (uint32_t k = 0; k < count; ++k) weights[k] /= sum;
}

static void add_linear(const measured* m, const float* weights)
{
    const size_t floats = 3 * (size_t)m->asset.vertex_count;
    float* restrict out = m->blended;
    memcpy(out, m->targets, floats * sizeof *out);
    for (uint32_t k = 1; k < m->asset.pose_count; ++k) {
        const float* restrict target = m->targets + floats * k;
        const float weight = weights[k];
        for (size_t i = 0; i < floats; ++i) out[i] += weight * target[i];
    }
}

static void run_frame(measured* m, int frame)
{
    float weights[max_poses], q[max_dimension];
    weights_of(frame, m->asset.pose_count, weights);
    const double start = now();
    pliant_solve(m->solver.solver, weights, q, NULL);
    const double solved = now();
    pliant_reconstruct(&m->asset, q, 0, m->asset.vertex_count, m->positions, 12);
    const double rebuilt = now();
    add_linear(m, weights);
    m->linear[frame] = now() - rebuilt;
    m->solve[frame] = solved - start;
    m->rebuild[frame] = rebuilt - solved;
}

static double size_of(const pliant_asset* asset, uint32_t tag)
{
    size_t size;
    pliant_asset_chunk(asset, tag, &size);
    return (double)size;
}

static void print_row(measured* m, const measured* first, const char* path, int frames)
{
    const pliant_asset* a = &m->asset;
    const double bytes = size_of(a, PLIANT_CHUNK_REST) + size_of(a, PLIANT_CHUNK_BASIS) + size_of(a, PLIANT_CHUNK_COMPACT)
        + size_of(a, PLIANT_CHUNK_FACTORED);
    const double solve = median(m->solve, frames), rebuild = median(m->rebuild, frames), linear = median(m->linear, frames);
    double farthest = 0.0;
    for (size_t v = 0; a->vertex_count == first->asset.vertex_count && v < a->vertex_count; ++v) {
        double squared = 0.0;
        for (size_t c = 0; c < 3; ++c)
            squared += pow((double)m->positions[3 * v + c] - (double)first->positions[3 * v + c], 2.0);
        farthest = fmax(farthest, sqrt(squared));
    }
    printf("| %s | %u | %u | %u | %.1f | %.1f | %.1f | %.1f | %.0f | %.0f | %.2g |\n", path, a->vertex_count, a->pose_count,
           a->dimension, solve, rebuild, linear, (solve + rebuild) / linear, bytes / 1024.0,
           12.0 * a->vertex_count * a->pose_count / 1024.0, farthest);
}

int main(int argc, char** argv)
{
    static measured assets[max_assets];
    const char* paths[max_assets];
    int count = 0, frames = 2000;
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--frames") == 0 && i + 1 < argc)
            frames = atoi(argv[++i]);
        else if (count < max_assets)
            paths[count++] = argv[i];
    }
    if (count == 0 || frames < 1) {
        fprintf(stderr, "usage: pliant_bench_frame ASSET... [--frames N]\n");
        return 2;
    }
    for (int i = 0; i < count; ++i)
        if (!open_measured(&assets[i], paths[i], frames)) return 1;
    for (int frame = 0; frame < frames; ++frame)
        for (int i = 0; i < count; ++i) run_frame(&assets[i], frame);
    printf("| asset | n | m | d | solve us | rebuild us | linear us | frame / linear | KiB read | linear | farthest |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < count; ++i) print_row(&assets[i], &assets[0], paths[i], frames);
    return 0;
}
