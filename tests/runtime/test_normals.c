/* Normals: against sums over all triangles in double precision, in any range and stride; fans, borders, several surfaces at
   one vertex, more corners than are put in order at a time; groups; triangles without area; the memory's size and alignment.
   That they are those of the numpy reference is tested in test_reference.c, that builds agree to the bit in test_bits.c. */
#include "support.h"

#include <math.h>

/* A mesh without a file: all that normals need of an asset. */
typedef struct surface {
    pliant_asset asset;
    float* positions;
    void* memory;
    pliant_normals normals;
} surface;

static surface make_surface(const uint32_t* triangles, uint32_t triangle_count, const float* positions,
                            uint32_t vertex_count, const uint32_t* groups)
{
    surface s;
    memset(&s, 0, sizeof s);
    s.asset.vertex_count = s.asset.boundary_vertex_count = vertex_count;
    s.asset.triangle_count = triangle_count;
    s.asset.triangles = triangles;
    s.asset.smoothing_groups = groups;
    s.positions = malloc((size_t)vertex_count * 12);
    const size_t size = pliant_normals_memory(&s.asset);
    s.memory = malloc(size);
    if (!s.positions || !s.memory) exit(2);
    memcpy(s.positions, positions, (size_t)vertex_count * 12);
    CHECK(pliant_normals_init(&s.normals, &s.asset, s.memory, size) == PLIANT_OK, "%u triangles", triangle_count);
    CHECK(s.normals.memory_used <= size && s.normals.neighbour_count <= 6 * triangle_count, "%zu of %zu bytes",
          s.normals.memory_used, size);
    return s;
}

static void free_surface(surface s)
{
    free(s.positions);
    free(s.memory);
}

static void expected_normal(const surface* s, uint32_t vertex, double* normal)
{
    const uint32_t* groups = s->asset.smoothing_groups;
    const float* centre = s->positions + 3 * (size_t)vertex;
    double length = 0.0, sum[3] = { 0.0, 0.0, 0.0 };
    for (size_t i = 0; i < 3 * (size_t)s->asset.triangle_count; ++i) {
        const uint32_t* t = s->asset.triangles + i / 3 * 3;
        const uint32_t a = t[i % 3];
        double e[3], f[3];
        if (groups ? groups[a] != groups[vertex] : a != vertex) continue;
        for (int c = 0; c < 3; ++c) {
            e[c] = (double)s->positions[3 * (size_t)t[(i + 1) % 3] + (size_t)c] - (double)centre[c];
            f[c] = (double)s->positions[3 * (size_t)t[(i + 2) % 3] + (size_t)c] - (double)centre[c];
        }
        for (int c = 0; c < 3; ++c) sum[c] += e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3];
    }
    for (int c = 0; c < 3; ++c) length += sum[c] * sum[c];
    for (int c = 0; c < 3; ++c) normal[c] = length > 0.0 ? sum[c] / sqrt(length) : (double)(c == 2);
}

static void check_surface(const surface* s, const char* name)
{
    const uint32_t n = s->asset.vertex_count;
    float* found = malloc((size_t)n * 12);
    if (!found) exit(2);
    pliant_normals_compute(&s->normals, s->positions, 12, 0, n, found, 12);
    for (uint32_t v = 0; v < n; ++v) {
        double expected[3], error = 0.0;
        expected_normal(s, v, expected);
        for (uint32_t c = 0; c < 3; ++c) error += fabs((double)found[3 * (size_t)v + c] - expected[c]);
        CHECK(error < 1e-5, "%s: vertex %u has %g %g %g, expected %g %g %g", name, v, (double)found[3 * v],
              (double)found[3 * v + 1], (double)found[3 * v + 2], expected[0], expected[1], expected[2]);
    }
    free(found);
}

/* ----------------------------------------------------------------------------------------------------- topologies ---- */

enum { MANY = 300 };

/* Any triangles among few vertices: fans of several pieces, edges with many faces, vertices twice in a triangle. */
static void check_random_triangles(void)
{
    uint64_t state = 41;
    for (int round = 0; round < 40; ++round) {
        uint32_t triangles[3 * MANY], groups[32];
        float positions[3 * 32];
        const uint32_t n = 1 + random_below(&state, 32), t = 1 + random_below(&state, round < 30 ? 40 : MANY);
        for (uint32_t i = 0; i < 3 * t; ++i) triangles[i] = random_below(&state, n);
        for (uint32_t i = 0; i < 3 * n; ++i) positions[i] = random_unit(&state) - 0.5f;
        for (uint32_t v = 0; v < n; ++v) groups[v] = random_below(&state, n);
        surface s = make_surface(triangles, t, positions, n, round % 2 ? groups : NULL);
        check_surface(&s, "random triangles");
        free_surface(s);
    }
}

/* A closed fan around vertex 0, its triangles in any order. With more corners than are put in order at a time, too. */
static void check_fan(uint32_t count, uint32_t left_out)
{
    uint32_t triangles[3 * MANY];
    float positions[3 * (MANY + 1)] = { 0.0f, 0.0f, 0.5f };
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t at = i * 7 % count; /* no count here is a multiple of 7 */
        const double angle = 6.283185307179586 * i / count;
        triangles[3 * i] = 1 + at;
        triangles[3 * i + 1] = 1 + (at + 1) % count;
        triangles[3 * i + 2] = 0;
        positions[3 * i + 3] = (float)cos(angle);
        positions[3 * i + 4] = (float)sin(angle);
        positions[3 * i + 5] = i % 3 == 0 ? 0.1f : 0.0f;
    }
    surface s = make_surface(triangles, count - left_out, positions, count + 1, NULL);
    check_surface(&s, "fan");
    const uint32_t corners = count - left_out, words = s.normals.starts[1] - s.normals.starts[0];
    if (corners <= 64)
        CHECK(words == corners + 1, "a fan of %u corners takes %u words", corners, words);
    else
        CHECK(words <= 2 * corners, "a fan of %u corners takes %u words", corners, words);
    free_surface(s);
}

/* --------------------------------------------------------------------------------------------------- special cases ---- */

/* Two squares at a right angle that share the edge x = 1, its vertices split: sharp, or smooth if they are of a group. */
static void check_groups(void)
{
    static const uint32_t triangles[12] = { 0, 1, 2, 0, 2, 3, 4, 6, 7, 4, 7, 5 };
    static const uint32_t smooth[8] = { 0, 1, 2, 3, 1, 2, 6, 7 };
    static const float positions[24] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 1, 0, -1, 1, 1, -1 };
    float normal[2][3];
    for (int is_smooth = 0; is_smooth < 2; ++is_smooth) {
        surface s = make_surface(triangles, 4, positions, 8, is_smooth ? smooth : NULL);
        check_surface(&s, "groups");
        pliant_normals_compute(&s.normals, s.positions, 12, 1, 1, normal[0], 12);
        pliant_normals_compute(&s.normals, s.positions, 12, 4, 1, normal[1], 12);
        const int are_equal = memcmp(normal[0], normal[1], sizeof normal[0]) == 0;
        CHECK(are_equal == is_smooth, "groups %d: z %g and %g", is_smooth, (double)normal[0][2], (double)normal[1][2]);
        if (!is_smooth) CHECK(normal[0][2] == 1.0f && normal[1][0] == 1.0f, "a split edge is not sharp");
        free_surface(s);
    }
}

static int is_unit(const float* n)
{
    const float squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    return squared > 0.999f && squared < 1.001f;
}

/* Whatever the positions, a normal has length 1. */
static void check_degenerate(void)
{
    static const uint32_t triangles[6] = { 0, 1, 2, 0, 0, 1 };
    static const float values[] = { 0.0f, 1.0f, -1.0f, 1e-30f, 1e30f, 3e38f, 1e-45f, INFINITY, -INFINITY, NAN };
    enum { VALUES = sizeof values / sizeof *values };
    uint64_t state = 43;
    for (int round = 0; round < 5000; ++round) {
        float positions[12], normals[12];
        for (int i = 0; i < 12; ++i) positions[i] = values[random_below(&state, round < 2500 ? 4 : VALUES)];
        surface s = make_surface(triangles, 2, positions, 4, NULL);
        pliant_normals_compute(&s.normals, s.positions, 12, 0, 4, normals, 12);
        for (int v = 0; v < 4; ++v)
            CHECK(is_unit(normals + 3 * v), "round %d: vertex %d has %g %g %g", round, v, (double)normals[3 * v],
                  (double)normals[3 * v + 1], (double)normals[3 * v + 2]);
        CHECK(normals[9] == 0.0f && normals[10] == 0.0f && normals[11] == 1.0f, "a vertex without a triangle");
        free_surface(s);
    }
}

/* A fan whose centre is split into `count` vertices of one group. */
static pliant_result init_fan(uint32_t count)
{
    uint32_t* triangles = malloc((size_t)count * 12);
    uint32_t* groups = calloc(3 * (size_t)count, 4);
    pliant_normals normals;
    pliant_asset asset;
    memset(&asset, 0, sizeof asset);
    asset.vertex_count = asset.boundary_vertex_count = 3 * count;
    asset.triangle_count = count;
    asset.triangles = triangles;
    asset.smoothing_groups = groups;
    const size_t size = pliant_normals_memory(&asset);
    void* memory = malloc(size);
    if (!triangles || !groups || !memory) exit(2);
    for (uint32_t i = 0; i < 3 * count; ++i) groups[i] = i % 3 ? i : 0;
    for (uint32_t i = 0; i < 3 * count; ++i) triangles[i] = i;
    const pliant_result result = pliant_normals_init(&normals, &asset, memory, size);
    free(triangles);
    free(groups);
    free(memory);
    return result;
}

static void check_large_groups(void)
{
    CHECK(init_fan(1000) == PLIANT_OK, "1,000 vertices read 2,000 neighbours each");
    CHECK(init_fan(4000) == PLIANT_ERROR_LIMIT, "4,000 vertices read 8,000 neighbours each");
}

static void check_memory(const opened* o)
{
    const size_t size = pliant_normals_memory(&o->asset);
    const uint32_t n = o->asset.boundary_vertex_count;
    unsigned char* block = malloc(size + 80);
    float* positions = malloc((size_t)n * 36);
    if (!block || !positions) exit(2);
    float *whole = positions + 3 * (size_t)n, *again = whole + 3 * (size_t)n;
    pliant_normals normals;
    CHECK(pliant_normals_init(&normals, &o->asset, block, size - 1) == PLIANT_ERROR_MEMORY_SIZE, "%s: a byte less", o->name);
    CHECK(normals.starts == NULL && normals.vertex_count == 0, "%s: a failed init leaves something", o->name);
    CHECK(pliant_normals_init(&normals, &o->asset, NULL, size) == PLIANT_ERROR_ARGUMENT, "%s: no memory", o->name);
    CHECK(pliant_normals_init(&normals, NULL, block, size) == PLIANT_ERROR_ARGUMENT, "%s: no asset", o->name);
    CHECK(pliant_normals_init(NULL, &o->asset, block, size) == PLIANT_ERROR_ARGUMENT, "%s: nowhere to put it", o->name);
    pliant_reconstruct(&o->asset, pliant_asset_pose_coordinates(&o->asset, 1), 0, n, positions, 12);
    for (size_t offset = 0; offset < 8; ++offset) {
        memset(block, 0xA5, size + 80);
        CHECK(pliant_normals_init(&normals, &o->asset, block + offset, size) == PLIANT_OK, "%s: at %zu", o->name, offset);
        for (size_t i = 0; i < offset; ++i) CHECK(block[i] == 0xA5, "%s: wrote before the memory", o->name);
        for (size_t i = offset + size; i < size + 80; ++i) CHECK(block[i] == 0xA5, "%s: wrote behind it", o->name);
        CHECK(normals.memory_used <= size, "%s: uses %zu of %zu", o->name, normals.memory_used, size);
        memset(block + offset + normals.memory_used, 0xA5, size - normals.memory_used); /* given back */
        pliant_normals_compute(&normals, positions, 12, 0, n, offset ? again : whole, 12);
        CHECK(offset == 0 || memcmp(whole, again, (size_t)n * 12) == 0, "%s: other normals at %zu", o->name, offset);
    }
    free(block);
    free(positions);
}

/* Any range, written beside the positions into one buffer, gives what the whole gives and nothing else. */
static void check_ranges(const opened* o)
{
    const uint32_t n = o->asset.boundary_vertex_count;
    const size_t size = pliant_normals_memory(&o->asset);
    void* memory = malloc(size);
    float* whole = malloc((size_t)n * 24);
    unsigned char *buffer = malloc((size_t)n * 32), *before = malloc((size_t)n * 32);
    uint64_t state = 47;
    pliant_normals normals;
    if (!memory || !whole || !buffer || !before) exit(2);
    if (pliant_normals_init(&normals, &o->asset, memory, size) != PLIANT_OK) exit(2);
    const float* q = pliant_asset_pose_coordinates(&o->asset, 1);
    pliant_reconstruct(&o->asset, q, 0, n, whole, 12);
    pliant_normals_compute(&normals, whole, 12, 0, n, whole + 3 * (size_t)n, 12);
    memset(buffer, 0xCD, (size_t)n * 32);
    pliant_reconstruct(&o->asset, q, 0, n, (float*)(void*)buffer, 32);
    for (int round = 0; round < 500; ++round) {
        const uint32_t first = random_below(&state, n + 3), count = random_below(&state, n + 3);
        const uint32_t written = first < n ? (count < n - first ? count : n - first) : 0;
        for (uint32_t v = 0; v < n; ++v) memset(buffer + 32 * (size_t)v + 12, 0xCD, 20);
        memcpy(before, buffer, (size_t)n * 32);
        for (uint32_t v = first; v < first + written; ++v)
            memcpy(before + 32 * (size_t)v + 12, whole + 3 * ((size_t)n + v), 12);
        pliant_normals_compute(&normals, (const float*)(const void*)buffer, 32, first, count,
                               (float*)(void*)(buffer + 32 * (size_t)(first < n ? first : 0) + 12), 32);
        CHECK(memcmp(buffer, before, (size_t)n * 32) == 0, "%s: %u+%u", o->name, first, count);
    }
    pliant_normals_compute(NULL, whole, 12, 0, n, whole, 12);
    pliant_normals_compute(&normals, NULL, 12, 0, n, whole, 12);
    pliant_normals_compute(&normals, whole, 12, 0xFFFFFFFFu, 1, whole, 12);
    free(memory);
    free(whole);
    free(buffer);
    free(before);
}

static void check_asset(const opened* o)
{
    check_memory(o);
    check_ranges(o);
}

int main(int argc, char** argv)
{
    static const uint32_t fans[] = { 3, 4, 6, 63, 64, 65, 130, MANY - 1 };
    if (argc != 2) return 2;
    for (size_t i = 0; i < sizeof fans / sizeof *fans; ++i) {
        if (fans[i] % 7 == 0) continue;
        check_fan(fans[i], 0);
        check_fan(fans[i], 1);
    }
    check_random_triangles();
    check_groups();
    check_degenerate();
    check_large_groups();
    CHECK(pliant_normals_memory(NULL) == 0, "memory of nothing");
    for_each_asset(argv[1], check_asset);
    return report("normals");
}
