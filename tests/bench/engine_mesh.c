#include "engine_mesh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Vertices whose dual quaternions are blended before they are applied, side by side. */
enum { block = 16 };

typedef float floats_4 __attribute__((vector_size(16)));
typedef float floats_8 __attribute__((vector_size(32)));

static void* allocate(size_t size)
{
    void* memory = calloc(1, size);
    if (!memory) exit(2);
    return memory;
}

static float square_distance(const float* a, const float* b)
{
    float sum = 0.0f;
    for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
    return sum;
}

/* The nearest bones of one vertex, by insertion, and the inverse squares of their distances as weights. */
static void hang(const engine_mesh* mesh, size_t vertex)
{
    const float* rest = mesh->targets;
    float nearest[influence_count] = { INFINITY, INFINITY, INFINITY, INFINITY }, sum = 0.0f;
    uint8_t* bones = mesh->bones + influence_count * vertex;
    for (size_t b = 0; b < bone_count; ++b) {
        float distance = square_distance(rest + 3 * vertex, rest + 3 * (mesh->vertex_count * b / bone_count));
        uint8_t bone = (uint8_t)b;
        for (int i = 0; i < influence_count; ++i) {
            if (distance >= nearest[i]) continue;
            const float further = nearest[i];
            const uint8_t moved = bones[i];
            nearest[i] = distance, bones[i] = bone;
            distance = further, bone = moved;
        }
    }
    for (int i = 0; i < influence_count; ++i) {
        nearest[i] = 1.0f / (nearest[i] + FLT_MIN); /* a bone may sit at the vertex itself */
        sum += nearest[i];
    }
    for (int i = 0; i < influence_count; ++i) mesh->influence[influence_count * vertex + (size_t)i] = nearest[i] / sum;
}

engine_mesh make_engine_mesh(size_t vertex_count, uint32_t pose_count, const float* poses)
{
    const size_t floats = 3 * vertex_count, influences = influence_count * vertex_count;
    engine_mesh mesh = { vertex_count, pose_count, allocate(floats * pose_count * sizeof(float)), allocate(influences),
                         allocate(influences * sizeof(float)) };
    for (size_t k = 0; k < pose_count; ++k)
        for (size_t i = 0; i < floats; ++i) mesh.targets[floats * k + i] = poses[floats * k + i] - (k > 0 ? poses[i] : 0.0f);
    for (size_t v = 0; v < vertex_count; ++v) hang(&mesh, v);
    return mesh;
}

/* A turn by `angle` about the axis (1, b/10, 0), then a small move. */
static void pose_bone(int b, float angle, float* matrix, float* dual)
{
    const float length = sqrtf(1.0f + 0.01f * (float)(b * b)), s = sinf(0.5f * angle) / length, w = cosf(0.5f * angle);
    const float x = s, y = 0.1f * (float)b * s, t[3] = { 0.01f * angle, -0.02f * angle, 0.03f * angle };
    const float columns[4][4] = { { 1 - 2 * y * y, 2 * x * y, -2 * y * w, 0 },
                                  { 2 * x * y, 1 - 2 * x * x, 2 * x * w, 0 },
                                  { 2 * y * w, -2 * x * w, 1 - 2 * (x * x + y * y), 0 },
                                  { t[0], t[1], t[2], 0 } };
    const float numbers[8] = { x,
                               y,
                               0,
                               w, /* the dual part is (t, 0) times the real one, halved */
                               0.5f * (t[0] * w - t[2] * y),
                               0.5f * (t[1] * w + t[2] * x),
                               0.5f * (t[2] * w + t[0] * y - t[1] * x),
                               -0.5f * (t[0] * x + t[1] * y) };
    memcpy(matrix, columns, sizeof columns);
    memcpy(dual, numbers, sizeof numbers);
}

void pose_bones(int frame, bone_pose* pose)
{
    for (int b = 0; b < bone_count; ++b)
        pose_bone(b, 0.5f * sinf(0.01f * (float)frame + (float)b), pose->matrices[b], pose->duals[b]);
}

void blend_linearly(const engine_mesh* mesh, const float* weights, float* out)
{
    const size_t floats = 3 * mesh->vertex_count;
    /* Pieces that stay in the first-level cache: the sum is read and written once per target. */
    for (size_t start = 0; start < floats; start += 2048) {
        const size_t count = floats - start < 2048 ? floats - start : 2048;
        float* restrict piece = out + start;
        memcpy(piece, mesh->targets + start, count * sizeof *piece);
        for (uint32_t k = 1; k < mesh->pose_count; ++k) {
            const float* restrict target = mesh->targets + floats * k + start;
            const float weight = weights[k];
            for (size_t i = 0; i < count; ++i) piece[i] += weight * target[i];
        }
    }
}

static floats_8 load_8(const float* numbers)
{
    floats_8 loaded;
    memcpy(&loaded, numbers, sizeof loaded);
    return loaded;
}

void blend_matrices(const engine_mesh* mesh, const bone_pose* pose, float* out)
{
    for (size_t v = 0; v < mesh->vertex_count; ++v) {
        const float* x = mesh->targets + 3 * v;
        const uint8_t* bones = mesh->bones + influence_count * v;
        const float* influence = mesh->influence + influence_count * v;
        floats_8 left = { 0.0f }, right = { 0.0f }; /* columns 0 and 1, 2 and 3 */
        for (int i = 0; i < influence_count; ++i) {
            left += influence[i] * load_8(pose->matrices[bones[i]]);
            right += influence[i] * load_8(pose->matrices[bones[i]] + 8);
        }
        const floats_8 first = { x[0], x[0], x[0], x[0], x[1], x[1], x[1], x[1] };
        const floats_8 second = { x[2], x[2], x[2], x[2], 1.0f, 1.0f, 1.0f, 1.0f };
        const floats_8 both = left * first + right * second;
        for (int c = 0; c < 3; ++c) out[3 * v + (size_t)c] = both[c] + both[c + 4];
    }
}

/* x is turned by the unit real part and moved by the dual part, after both are divided by the length of the real one. */
static void apply_dual(const float* restrict d, const float* restrict x, float* restrict out)
{
    const float inverse = 1.0f / sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + d[3] * d[3]);
    const float a = d[0] * inverse, b = d[1] * inverse, c = d[2] * inverse, w = d[3] * inverse;
    const float e = d[4] * inverse, f = d[5] * inverse, g = d[6] * inverse, h = d[7] * inverse;
    const float u = b * x[2] - c * x[1] + w * x[0] + e, v = c * x[0] - a * x[2] + w * x[1] + f,
                t = a * x[1] - b * x[0] + w * x[2] + g;
    out[0] = x[0] + 2.0f * (b * t - c * v + w * e - h * a);
    out[1] = x[1] + 2.0f * (c * u - a * t + w * f - h * b);
    out[2] = x[2] + 2.0f * (a * v - b * u + w * g - h * c);
}

void blend_dual_quaternions(const engine_mesh* mesh, const bone_pose* pose, float* out)
{
    for (size_t start = 0; start < mesh->vertex_count; start += block) {
        const size_t count = mesh->vertex_count - start < block ? mesh->vertex_count - start : block;
        float blended[block][8];
        for (size_t i = 0; i < count; ++i) {
            const uint8_t* bones = mesh->bones + influence_count * (start + i);
            const float* influence = mesh->influence + influence_count * (start + i);
            floats_8 sum = { 0.0f };
            for (int j = 0; j < influence_count; ++j) sum += influence[j] * load_8(pose->duals[bones[j]]);
            memcpy(blended[i], &sum, sizeof sum);
        }
        for (size_t i = 0; i < count; ++i) apply_dual(blended[i], mesh->targets + 3 * (start + i), out + 3 * (start + i));
    }
}
