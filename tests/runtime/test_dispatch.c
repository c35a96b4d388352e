/* The copies of the kernels for AVX2 and AVX-512 give the bits of the plain ones: energy and gradient at random points,
   blends while dragging and jumping, tiles of vertices, normals, for all eleven kinds of elements and the quartic. Where a
   processor has AVX2 or AVX-512 they are what it gets. (test_unpack.c compares them on tiles of every kind.) */
#include "internal.h"
#include "support.h"

#include <math.h>

static const pliant_kernels *chosen, *compared;
static int seen[PLIANT_ELEMENT_LAYERED_ARAP_CELL + 1]; /* elements of each kind; [0]: assets with a quartic */

static int seen_compact, seen_factored;

static int are_same(const float* a, const float* b, size_t count) { return memcmp(a, b, count * sizeof *a) == 0; }

/* A solver that uses the given kernels. */
static made_solver make_solver_with(const pliant_kernels* kernels, const pliant_asset* asset)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    made_solver made = make_solver(asset, &desc);
    CHECK(made.solver->kernels == chosen, "a new solver does not have the kernels of this processor");
    made.solver->kernels = kernels;
    return made;
}

static void count_kinds(const opened* o)
{
    const pliant_format_batch* batches = o->asset.batches;
    seen[0] += o->asset.quartic != NULL;
    for (uint32_t i = 0; i < o->asset.batch_count; ++i) seen[batches[i].kind] += (int)batches[i].element_count;
}

/* Away from the poses, where nothing is zero by luck; some points are too far to be finite, and both have to say so. */
static void check_evaluations(const opened* o, pliant_solver* plain, pliant_solver* copy)
{
    static const float sizes[4] = { 0.0f, 0.01f, 0.1f, 0.5f };
    const uint32_t d = o->asset.dimension, m = o->asset.pose_count;
    const float scale = sqrtf(o->asset.energy_scale);
    uint64_t state = 29;
    int finite = 0;
    for (int round = 0; round < 40; ++round) {
        float z[PLIANT_FORMAT_MAX_DIMENSION] = { 0 };
        double energy[2] = { 0.0, 0.0 };
        plain->weights[0] = 1.0f;
        random_blend(&state, &o->asset, plain->weights + o->asset.has_layers);
        memcpy(copy->weights, plain->weights, m * sizeof(float));
        for (uint32_t j = 0; j < d; ++j) z[j] = sizes[round % 4] * scale * (random_unit(&state) - 0.5f);
        pliant_solver_combine(plain);
        pliant_solver_combine(copy);
        const int is_finite = pliant_solver_evaluate(plain, z, &energy[0], plain->gradient);
        CHECK(pliant_solver_evaluate(copy, z, &energy[1], copy->gradient) == is_finite, "%s: round %d", o->name, round);
        if (!is_finite) continue;
        ++finite;
        CHECK(memcmp(&energy[0], &energy[1], sizeof energy[0]) == 0, "%s: energies %.17g and %.17g", o->name, energy[0],
              energy[1]);
        CHECK(are_same(plain->gradient, copy->gradient, o->asset.padded_dimension), "%s: gradient in round %d", o->name,
              round);
    }
    CHECK(finite >= 20, "%s: only %d points can be evaluated", o->name, finite);
}

/* Jumps and drags: what learns from them adds up every difference. */
static void check_blends(const opened* o, pliant_solver* plain, pliant_solver* copy)
{
    uint64_t state = 31;
    float weights[PLIANT_FORMAT_MAX_POSES], q[2][PLIANT_FORMAT_MAX_DIMENSION];
    for (int frame = 0; frame < 60; ++frame) {
        pliant_solve_info info[2];
        if (frame % 6 == 0) random_blend(&state, &o->asset, weights);
        weights[frame % (int)o->asset.weight_count] += 0.03f;
        CHECK(pliant_solve(plain, weights, q[0], &info[0]) == PLIANT_OK, "%s: frame %d", o->name, frame);
        CHECK(pliant_solve(copy, weights, q[1], &info[1]) == PLIANT_OK, "%s: frame %d", o->name, frame);
        CHECK(are_same(q[0], q[1], o->asset.dimension), "%s: blend of frame %d", o->name, frame);
        CHECK(are_same(&info[0].energy, &info[1].energy, 1) && are_same(&info[0].gradient, &info[1].gradient, 1)
                  && info[0].evaluations == info[1].evaluations,
              "%s: descent of frame %d", o->name, frame);
        CHECK(are_same(plain->inverse_hessian, copy->inverse_hessian,
                       (size_t)o->asset.padded_dimension * o->asset.padded_dimension),
              "%s: matrix of frame %d", o->name, frame);
    }
}

static void check_products(const opened* o)
{
    float q[PLIANT_FORMAT_MAX_DIMENSION], tile[2][PLIANT_FORMAT_COMPACT_PARTS * PLIANT_FORMAT_TILE_FLOATS] = { { 0 } };
    const uint32_t blocks = pliant_format_block_count(o->asset.vertex_count, o->asset.block_vertices);
    pliant_frame frame;
    uint64_t state = 37;
    for (uint32_t j = 0; j < o->asset.dimension; ++j) q[j] = random_unit(&state) - 0.5f;
    pliant_frame_begin(&o->asset, q, o->asset.dimension, &frame);
    for (uint32_t t = 0; t < o->asset.blocks[blocks]; ++t) {
        const size_t parts = pliant_format_product_parts(o->asset.products + t);
        pliant_kernels_plain.rebuild_factored(&o->asset, &frame, t, tile[0]);
        compared->rebuild_factored(&o->asset, &frame, t, tile[1]);
        CHECK(are_same(tile[0], tile[1], parts * PLIANT_FORMAT_TILE_FLOATS), "%s: tile %u", o->name, t);
        ++seen_factored;
    }
}

static void check_tiles(const opened* o)
{
    float q[PLIANT_FORMAT_MAX_DIMENSION], tile[2][PLIANT_FORMAT_COMPACT_PARTS * PLIANT_FORMAT_TILE_FLOATS] = { { 0 } };
    pliant_frame frame;
    uint64_t state = 37;
    if (o->asset.products) {
        check_products(o);
        return;
    }
    for (uint32_t j = 0; j < o->asset.dimension; ++j) q[j] = random_unit(&state) - 0.5f;
    pliant_frame_begin(&o->asset, q, o->asset.dimension, &frame);
    const size_t count = (o->asset.vertex_count + PLIANT_FORMAT_TILE_VERTICES - 1) / PLIANT_FORMAT_TILE_VERTICES;
    const size_t parts = o->asset.columns ? PLIANT_FORMAT_COMPACT_PARTS : 1;
    for (size_t t = 0; t < count; t += parts) {
        const size_t end = count - t < parts ? count - t : parts;
        if (o->asset.columns) {
            pliant_kernels_plain.rebuild_compact(&o->asset, &frame, t / parts, 0, end, tile[0]);
            compared->rebuild_compact(&o->asset, &frame, t / parts, 0, end, tile[1]);
        } else {
            pliant_kernels_plain.rebuild_tile(&o->asset, &frame, t, tile[0]);
            compared->rebuild_tile(&o->asset, &frame, t, tile[1]);
        }
        CHECK(are_same(tile[0], tile[1], end * PLIANT_FORMAT_TILE_FLOATS), "%s: tile %u", o->name, (unsigned)t);
        seen_compact += o->asset.columns != NULL;
    }
}

static void check_normals(const opened* o)
{
    const uint32_t n = o->asset.boundary_vertex_count;
    const size_t size = pliant_normals_memory(&o->asset);
    float* positions = malloc((size_t)n * 12);
    void* memory = malloc(size);
    pliant_normals normals;
    if (!positions || !memory || pliant_normals_init(&normals, &o->asset, memory, size) != PLIANT_OK) exit(2);
    pliant_reconstruct(&o->asset, pliant_asset_pose_coordinates(&o->asset, 1), 0, n, positions, 12);
    for (uint32_t v = 0; v < n; v += PLIANT_LANES) {
        float block[2][3 * PLIANT_LANES];
        const uint32_t count = n - v < PLIANT_LANES ? n - v : PLIANT_LANES;
        const unsigned char* bytes = (const unsigned char*)positions;
        pliant_kernels_plain.normals_of_block(&normals, bytes, 12, v, count, block[0]);
        compared->normals_of_block(&normals, bytes, 12, v, count, block[1]);
        CHECK(are_same(block[0], block[1], 3 * PLIANT_LANES), "%s: normals from vertex %u on", o->name, v);
    }
    free(memory);
    free(positions);
}

static void check_asset(const opened* o)
{
    const made_solver plain = make_solver_with(&pliant_kernels_plain, &o->asset);
    const made_solver copy = make_solver_with(compared, &o->asset);
    count_kinds(o);
    check_evaluations(o, plain.solver, copy.solver);
    check_blends(o, plain.solver, copy.solver);
    check_tiles(o);
    check_normals(o);
    free(plain.memory);
    free(copy.memory);
}

static int skip(const char* reason)
{
    CHECK(chosen == &pliant_kernels_plain, "%s, and yet other kernels than the plain ones", reason);
    printf("skipped: %s\n", reason);
    return failure_count ? 1 : 77;
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    chosen = pliant_kernels_choose();
#if PLIANT_HAS_AVX2_COPY
    if (!__builtin_cpu_supports("avx2")) return skip("this processor has no AVX2");
    if (chosen != &pliant_kernels_avx2) {
        CHECK(chosen == &pliant_kernels_avx512 && __builtin_cpu_supports("avx512bw"), "kernels that no table knows");
        compared = &pliant_kernels_avx2;
        for_each_asset(argv[1], check_asset);
    }
    compared = chosen;
#else
    return skip("this build has no second copy");
#endif
    CHECK(chosen != &pliant_kernels_plain, "a processor with AVX2 gets the plain kernels");
    for_each_asset(argv[1], check_asset);
    for (int kind = 0; kind <= PLIANT_ELEMENT_LAYERED_ARAP_CELL; ++kind)
        CHECK(seen[kind] > 0, "nothing of kind %d in any asset", kind);
    CHECK(seen_compact > 0, "no tile of a compact basis");
    CHECK(seen_factored > 0, "no tile of a factored basis");
    return report("dispatch");
}
