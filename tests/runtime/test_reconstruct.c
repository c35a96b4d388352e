/* Reconstruction: poses come back, ranges and strides of any kind equal the whole, nothing else is written. */
#include "support.h"

#include <math.h>

static void check_ranges(const opened* o)
{
    const uint32_t n = o->asset.vertex_count;
    float* whole = malloc((size_t)n * 12);
    unsigned char* part = malloc((size_t)n * 64 + 64);
    float q[256];
    uint64_t state = 23;
    if (!whole || !part) exit(2);
    for (uint32_t j = 0; j < o->asset.dimension; ++j) q[j] = random_unit(&state) - 0.5f;
    pliant_reconstruct(&o->asset, q, 0, n, whole, 12);
    for (int round = 0; round < 2000; ++round) {
        const uint32_t first = random_below(&state, n + 3), count = random_below(&state, n + 3);
        const size_t stride = 12 + 4 * (size_t)random_below(&state, 13);
        const uint32_t written = first < n ? (count < n - first ? count : n - first) : 0;
        const size_t size = (size_t)n * 64 + 64;
        memset(part, 0xCD, size);
        pliant_reconstruct(&o->asset, q, first, count, (float*)(void*)part, stride);
        for (uint32_t i = 0; i < written; ++i)
            CHECK(memcmp(part + i * stride, whole + 3 * (size_t)(first + i), 12) == 0, "%s: %u of %u+%u, stride %zu",
                  o->name, i, first, count, stride);
        for (size_t at = 0; at < size; ++at) {
            const int inside = at / stride < written && at % stride < 12;
            if (!inside) CHECK(part[at] == 0xCD, "%s: wrote at %zu of %u+%u, stride %zu", o->name, at, first, count, stride);
        }
    }
    pliant_reconstruct(&o->asset, q, 0, 0xFFFFFFFFu, whole, 12); /* a count past the end is cut */
    pliant_reconstruct(&o->asset, q, 0xFFFFFFFFu, 1, whole, 12);
    pliant_reconstruct(NULL, q, 0, 1, whole, 12);
    free(whole);
    free(part);
}

/* y = origin + rest + sum q_j u_j written out, in double. */
static void check_formula(const opened* o)
{
    const uint32_t d = o->asset.dimension;
    size_t rest_size, basis_size;
    const float* rest = pliant_asset_chunk(&o->asset, 0x54534552u /* REST */, &rest_size);
    const float* basis = pliant_asset_chunk(&o->asset, 0x49534142u /* BASI */, &basis_size);
    CHECK(rest && basis && rest_size % 192 == 0 && basis_size == rest_size * d, "%s: chunks", o->name);
    for (uint32_t k = 0; k < o->asset.pose_count; ++k) {
        const float* q = pliant_asset_pose_coordinates(&o->asset, k);
        for (uint32_t v = 0; v < o->asset.vertex_count; ++v) {
            float position[3];
            pliant_reconstruct(&o->asset, q, v, 1, position, 12);
            for (uint32_t c = 0; c < 3; ++c) {
                const size_t lane = 3 * (v % 16) + c;
                double expected = (double)o->asset.origin[c] + (double)rest[(v / 16) * 48 + lane];
                for (uint32_t j = 0; j < d; ++j) expected += (double)q[j] * (double)basis[((v / 16) * d + j) * 48 + lane];
                CHECK(fabs((double)position[c] - expected) < 1e-5, "%s: pose %u vertex %u", o->name, k, v);
            }
        }
    }
}

static void check_names(const opened* o)
{
    for (uint32_t k = 0; k < o->asset.pose_count; ++k) {
        char expected[32];
        snprintf(expected, sizeof expected, "pose %u", k);
        const char* name = pliant_asset_pose_name(&o->asset, k);
        CHECK(name && strcmp(name, expected) == 0, "%s: name %u is %s", o->name, k, name ? name : "missing");
    }
    CHECK(pliant_asset_pose_name(&o->asset, o->asset.pose_count) == NULL, "%s: one name too many", o->name);
    CHECK(pliant_asset_pose_coordinates(&o->asset, o->asset.pose_count) == NULL, "%s: one pose too many", o->name);
    size_t size = 1;
    CHECK(pliant_asset_chunk(&o->asset, 0x21212121u, &size) == NULL && size == 0, "%s: a chunk that is not there", o->name);
}

static void check_asset(const opened* o)
{
    check_ranges(o);
    if (o->asset.basis) check_formula(o); /* a compact one: test_compact.c */
    check_names(o);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_asset);
    return report("reconstruct");
}
