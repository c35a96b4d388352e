/* What a frame costs beside what engines do with the same vertices.
       pliant_bench_frame NAME=ASSET... [--frames N] [--characters N] [--threads N]
   Three Markdown tables. The first, microseconds of one character on one core, medians of N frames (1,000), all columns
   in turns in every frame: solve on a slow drag through the weights (of layers from one sparse random mixture to the
   next) and for random jumps, with evaluations of the surrogate energy a frame; rebuild all vertices; normals; and beside
   it, compiled for this processor with -O3 and -ffast-math (engine_mesh.c), the linear sum of the same poses in single
   precision, linear blend skinning and dual quaternions with 64 bones, four a vertex. The second, milliseconds of N
   characters (100), each with weights, a solver and vertices of its own, on N threads (2). The third, what a frame reads
   and what the file holds. Asserts nothing. */
#define _POSIX_C_SOURCE 200112L
#include "../../formats/pliant_format.h"
#include "../runtime/support.h"
#include "engine_mesh.h"
#include "layer_weights.h"
#include "timing.h"

#include <math.h>
#include <pthread.h>

enum { max_assets = 16, max_poses = 65, max_dimension = 256, max_threads = 64 };

typedef enum column { DRAG, JUMP, REBUILD, NORMALS, LINEAR, MATRICES, DUALS, COLUMN_COUNT } column;

typedef struct measured {
    const char* name;
    blob_file blob;
    pliant_asset asset;
    pliant_normals normals;
    engine_mesh others;
    made_solver drag, jump;
    float *positions, *directions;
    double* times[COLUMN_COUNT];
    double evaluations[2]; /* of DRAG and of JUMP */
    uint64_t random;
} measured;

static void* allocate(size_t size)
{
    void* memory = calloc(1, size);
    if (!memory) exit(2);
    return memory;
}

static made_solver make_default_solver(const pliant_asset* asset)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    return make_solver(asset, &desc);
}

static void open_measured(measured* m, const char* argument, int frames)
{
    const char* equals = strchr(argument, '=');
    const char* path = equals ? equals + 1 : argument;
    m->name = argument;
    m->blob = read_blob(path);
    const pliant_result result = pliant_asset_open(&m->asset, m->blob.data, m->blob.size, PLIANT_OPEN_DEFAULT);
    if (result != PLIANT_OK || m->asset.pose_count > max_poses) {
        fprintf(stderr, "%s: %s\n", path, result != PLIANT_OK ? pliant_result_text(result) : "too many poses");
        exit(2);
    }
    const size_t floats = 3 * (size_t)m->asset.vertex_count, memory = pliant_normals_memory(&m->asset);
    pliant_normals_init(&m->normals, &m->asset, allocate(memory), memory);
    m->drag = make_default_solver(&m->asset);
    m->jump = make_default_solver(&m->asset);
    m->positions = allocate(floats * sizeof(float));
    m->directions = allocate(floats * sizeof(float));
    m->random = 20261125;
    for (int c = 0; c < COLUMN_COUNT; ++c) m->times[c] = allocate((size_t)frames * sizeof(double));
    float* poses = allocate(floats * m->asset.pose_count * sizeof(float));
    for (uint32_t k = 0; k < m->asset.pose_count; ++k)
        pliant_reconstruct(&m->asset, pliant_asset_pose_coordinates(&m->asset, k), 0, m->asset.vertex_count,
                           poses + floats * k, 12);
    m->others = make_engine_mesh(m->asset.vertex_count, m->asset.pose_count, poses);
    free(poses);
}

/* Saw teeth of different lengths: all poses take part, and weights move by some thousandths a frame. */
static void drag_weights(int frame, float phase, uint32_t count, float* weights)
{
    float sum = 0.0f;
    for (uint32_t k = 0; k < count; ++k) {
        const float place = 0.002f * (float)frame * (1.0f + 0.37f * (float)k) + 0.21f * (float)k + phase;
        const float part = place - floorf(place);
        weights[k] = 0.01f + (part < 0.5f ? 2.0f * part : 2.0f - 2.0f * part);
        sum += weights[k];
    }
    for (uint32_t k = 0; k < count; ++k) weights[k] /= sum;
}

/* From one sparse random mixture of layers to the next in 200 frames. */
static void drag_layers(const pliant_asset* asset, int frame, float phase, float* weights)
{
    enum { frames_per_mixture = 200 };
    const uint64_t number = (uint64_t)(frame / frames_per_mixture) + (uint64_t)(1e6f * phase) + 1;
    const float along = (float)(frame % frames_per_mixture) / frames_per_mixture;
    float next[max_poses];
    uint64_t random = number * 6364136223846793005ull, random_next = (number + 1) * 6364136223846793005ull;
    draw_layers(asset, sparse_share(asset), &random, weights);
    draw_layers(asset, sparse_share(asset), &random_next, next);
    for (uint32_t k = 0; k < asset->weight_count; ++k) weights[k] += along * (next[k] - weights[k]);
}

static void drag(const pliant_asset* asset, int frame, float phase, float* weights)
{
    if (asset->has_layers)
        drag_layers(asset, frame, phase, weights);
    else
        drag_weights(frame, phase, asset->pose_count, weights);
}

/* The linear sum's weights, one for each pose: the first one is the rest shape of layers. */
static void weights_of_poses(const pliant_asset* asset, const float* weights, float* poses)
{
    poses[0] = 1.0f;
    memcpy(poses + asset->has_layers, weights, asset->weight_count * sizeof *weights);
}

static void jump_weights(const pliant_asset* asset, uint64_t* random, float* weights)
{
    if (asset->has_layers) {
        draw_layers(asset, sparse_share(asset), random, weights);
        return;
    }
    for (uint32_t k = 0; k < asset->weight_count; ++k) weights[k] = -logf(random_unit(random) + 1e-6f) + 1e-6f;
}

/* ----------------------------------------------------------------------------------------------- one character ---- */

static double solve(measured* m, column which, const float* weights, float* q)
{
    pliant_solver* solver = which == DRAG ? m->drag.solver : m->jump.solver;
    pliant_solve_info info;
    if (which == JUMP) pliant_solver_reset(solver);
    const double start = now();
    pliant_solve(solver, weights, q, &info);
    const double time = now() - start;
    m->evaluations[which] += (double)info.evaluations;
    return time;
}

static void run_frame(measured* m, int frame)
{
    static bone_pose bones;
    float weights[max_poses], poses[max_poses], jumped[max_poses], q[max_dimension], unused[max_dimension];
    double times[COLUMN_COUNT + 1];
    drag(&m->asset, frame, 0.0f, weights);
    weights_of_poses(&m->asset, weights, poses);
    jump_weights(&m->asset, &m->random, jumped);
    pose_bones(frame, &bones);
    m->times[JUMP][frame] = solve(m, JUMP, jumped, unused);
    m->times[DRAG][frame] = solve(m, DRAG, weights, q);
    times[REBUILD] = now();
    pliant_reconstruct(&m->asset, q, 0, m->asset.vertex_count, m->positions, 12);
    times[NORMALS] = now();
    pliant_normals_compute(&m->normals, m->positions, 12, 0, m->normals.vertex_count, m->directions, 12);
    times[LINEAR] = now();
    blend_linearly(&m->others, poses, m->positions);
    times[MATRICES] = now();
    blend_matrices(&m->others, &bones, m->positions);
    times[DUALS] = now();
    blend_dual_quaternions(&m->others, &bones, m->positions);
    times[COLUMN_COUNT] = now();
    for (int c = REBUILD; c < COLUMN_COUNT; ++c) m->times[c][frame] = times[c + 1] - times[c];
}

static void print_character(measured* m, int frames)
{
    double t[COLUMN_COUNT];
    for (int c = 0; c < COLUMN_COUNT; ++c) t[c] = median(m->times[c], frames);
    printf("| %.*s | %u | %u | %u | %.1f (%.1f) | %.1f (%.1f) | %.1f | %.1f | %.1f | %.1f | %.1f | %.2f |\n",
           (int)strcspn(m->name, "="), m->name, m->asset.vertex_count, m->asset.pose_count, m->asset.dimension, t[DRAG],
           m->evaluations[DRAG] / frames, t[JUMP], m->evaluations[JUMP] / frames, t[REBUILD], t[NORMALS], t[LINEAR],
           t[MATRICES], t[DUALS], (t[DRAG] + t[REBUILD]) / t[LINEAR]);
}

/* -------------------------------------------------------------------------------------------------------- crowd ---- */

typedef enum crowd_stage { CROWD_SOLVE, CROWD_REBUILD, CROWD_LINEAR, CROWD_MATRICES, CROWD_STAGE_COUNT } crowd_stage;

typedef struct crowd {
    const measured* m;
    int count, threads;
    made_solver* solvers;
    float *positions, *q, *weights, *poses; /* a row a character */
    bone_pose* bones;
} crowd;

typedef struct share {
    const crowd* crowd;
    crowd_stage stage;
    int first, end;
} share;

static void run_character(const crowd* c, crowd_stage stage, int i)
{
    const pliant_asset* asset = &c->m->asset;
    float* q = c->q + i * max_dimension;
    const float* weights = c->weights + i * max_poses;
    float* positions = c->positions + 3 * (size_t)asset->vertex_count * (size_t)i;
    switch (stage) {
    case CROWD_SOLVE: pliant_solve(c->solvers[i].solver, weights, q, NULL); break;
    case CROWD_REBUILD: pliant_reconstruct(asset, q, 0, asset->vertex_count, positions, 12); break;
    case CROWD_LINEAR: blend_linearly(&c->m->others, c->poses + i * max_poses, positions); break;
    default: blend_matrices(&c->m->others, c->bones, positions); break;
    }
}

static void* run_share(void* argument)
{
    const share* s = (const share*)argument;
    for (int i = s->first; i < s->end; ++i) run_character(s->crowd, s->stage, i);
    return NULL;
}

/* Milliseconds of one stage for all characters. */
static double run_stage(const crowd* c, crowd_stage stage)
{
    pthread_t threads[max_threads];
    share shares[max_threads];
    const double start = now();
    for (int t = 0; t < c->threads; ++t) {
        shares[t] = (share) { c, stage, c->count * t / c->threads, c->count * (t + 1) / c->threads };
        if (pthread_create(&threads[t], NULL, run_share, &shares[t]) != 0) exit(2);
    }
    for (int t = 0; t < c->threads; ++t) pthread_join(threads[t], NULL);
    return 1e-3 * (now() - start);
}

static void print_crowd(const measured* m, int count, int threads)
{
    enum { frames = 51 };
    static bone_pose bones;
    double times[CROWD_STAGE_COUNT][frames], t[CROWD_STAGE_COUNT];
    const size_t rows = (size_t)count, vertices = m->asset.vertex_count;
    crowd c = { m,
                count,
                threads,
                allocate(rows * sizeof(made_solver)),
                allocate(rows * vertices * 12),
                allocate(rows * max_dimension * sizeof(float)),
                allocate(rows * max_poses * sizeof(float)),
                allocate(rows * max_poses * sizeof(float)),
                &bones };
    for (int i = 0; i < count; ++i) c.solvers[i] = make_default_solver(&m->asset);
    for (int frame = 0; frame < frames; ++frame) {
        pose_bones(frame, &bones);
        for (int i = 0; i < count; ++i) {
            drag(&m->asset, frame, 0.37f * (float)i, c.weights + i * max_poses);
            weights_of_poses(&m->asset, c.weights + i * max_poses, c.poses + i * max_poses);
        }
        for (int s = 0; s < CROWD_STAGE_COUNT; ++s) times[s][frame] = run_stage(&c, (crowd_stage)s);
    }
    for (int s = 0; s < CROWD_STAGE_COUNT; ++s) t[s] = median(times[s], frames);
    printf("| %.*s | %d | %d | %.2f | %.2f | %.2f | %.2f | %.2f |\n", (int)strcspn(m->name, "="), m->name, count, threads,
           t[CROWD_SOLVE], t[CROWD_REBUILD], t[CROWD_LINEAR], t[CROWD_MATRICES],
           (t[CROWD_SOLVE] + t[CROWD_REBUILD]) / t[CROWD_LINEAR]);
    for (int i = 0; i < count; ++i) free(c.solvers[i].memory);
    free(c.solvers);
    free(c.positions);
    free(c.q);
    free(c.weights);
    free(c.poses);
}

/* -------------------------------------------------------------------------------------------------------- bytes ---- */

static double size_of(const pliant_asset* asset, uint32_t tag)
{
    size_t size;
    pliant_asset_chunk(asset, tag, &size);
    return (double)size;
}

static void print_bytes(const measured* m)
{
    const pliant_asset* a = &m->asset;
    const double n = (double)a->vertex_count;
    const double shape = size_of(a, PLIANT_CHUNK_REST) + size_of(a, PLIANT_CHUNK_BASIS) + size_of(a, PLIANT_CHUNK_COMPACT)
        + size_of(a, PLIANT_CHUNK_FACTORED);
    const double triangles = 12.0 * (double)a->triangle_count, linear = 12.0 * n * a->pose_count;
    printf("| %.*s | %.1f | %.1f | %d | %.0f | %.0f | %.0f |\n", (int)strcspn(m->name, "="), m->name, shape / n, linear / n,
           skin_bytes, (double)m->blob.size / 1024.0, (linear + triangles) / 1024.0, (skin_bytes * n + triangles) / 1024.0);
}

int main(int argc, char** argv)
{
    static measured assets[max_assets];
    int count = 0, frames = 1000, characters = 100, threads = 2;
    const char* names[max_assets];
    for (int i = 1; i < argc; ++i) {
        int* const option = strcmp(argv[i], "--frames") == 0 ? &frames
            : strcmp(argv[i], "--characters") == 0           ? &characters
            : strcmp(argv[i], "--threads") == 0              ? &threads
                                                             : NULL;
        if (option && i + 1 < argc)
            *option = atoi(argv[++i]);
        else if (!option && count < max_assets)
            names[count++] = argv[i];
    }
    if (count == 0 || frames < 1 || characters < 1 || threads < 1 || threads > max_threads) {
        fprintf(stderr, "usage: pliant_bench_frame NAME=ASSET... [--frames N] [--characters N] [--threads N]\n");
        return 2;
    }
    for (int i = 0; i < count; ++i) open_measured(&assets[i], names[i], frames);
    for (int frame = 0; frame < frames; ++frame)
        for (int i = 0; i < count; ++i) run_frame(&assets[i], frame);
    printf("| set | n | m | d | drag us (evaluations) | jump us | rebuild | normals | linear sum | skinning | dual "
           "quaternions | (drag + rebuild) / linear |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < count; ++i) print_character(&assets[i], frames);
    printf("\n| set | characters | threads | drag ms | rebuild | linear sum | skinning | (drag + rebuild) / linear |\n"
           "|---|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < count; ++i) print_crowd(&assets[i], characters, threads);
    printf("\n| set | bytes a vertex: Pliant | linear sum | skinning | file KiB: Pliant | linear sum | skinning |\n"
           "|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < count; ++i) print_bytes(&assets[i]);
    return 0;
}
