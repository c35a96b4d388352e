/* The kernel of normals: those of PLIANT_LANES vertices from the runs of neighbours that normals.c has made. */
#include "internal.h"

#include <math.h>

typedef struct vector {
    float x, y, z;
} vector;

static PLIANT_INLINE vector position_at(const unsigned char* positions, size_t stride, size_t vertex)
{
    vector p;
    memcpy(&p, positions + vertex * stride, sizeof p);
    return p;
}

static PLIANT_INLINE vector difference(vector a, vector b)
{
    const vector d = { a.x - b.x, a.y - b.y, a.z - b.z };
    return d;
}

static PLIANT_INLINE vector sum_of_corners(const pliant_normals* normals, const unsigned char* positions, size_t stride,
                                           size_t vertex)
{
    const size_t group = normals->groups ? normals->groups[vertex] : vertex;
    const size_t end = normals->starts[group + 1];
    const vector centre = position_at(positions, stride, vertex);
    vector sum = { 0.0f, 0.0f, 0.0f }, a = { 0.0f, 0.0f, 0.0f };
    for (size_t i = normals->starts[group]; i < end; ++i) {
        const uint32_t word = normals->neighbours[i];
        const vector b = difference(position_at(positions, stride, word & ~PLIANT_RUN_START), centre);
        if (!(word & PLIANT_RUN_START)) {
            sum.x += a.y * b.z - a.z * b.y;
            sum.y += a.z * b.x - a.x * b.z;
            sum.z += a.x * b.y - a.y * b.x;
        }
        a = b;
    }
    return sum;
}

static PLIANT_INLINE float larger(float a, float b) { return a > b ? a : b; }

/* Divided by its largest component first, so that squares neither vanish nor overflow. After that the squared length is from
   1 to 3, or not a number if the sum was zero, infinite or not a number itself: then the normal is +z. */
static PLIANT_INLINE void normalise_lanes(float* PLIANT_RESTRICT x, float* PLIANT_RESTRICT y, float* PLIANT_RESTRICT z)
{
    for (size_t i = 0; i < PLIANT_LANES; ++i) {
        const float largest = larger(fabsf(x[i]), larger(fabsf(y[i]), fabsf(z[i])));
        const float u = x[i] / largest, v = y[i] / largest, w = z[i] / largest;
        const float squared = u * u + v * v + w * w;
        const float factor = 1.0f / sqrtf(squared);
        const int is_direction = squared >= 0.5f;
        x[i] = is_direction ? u * factor : 0.0f;
        y[i] = is_direction ? v * factor : 0.0f;
        z[i] = is_direction ? w * factor : 1.0f;
    }
}

static PLIANT_INLINE void normals_of_block(const pliant_normals* normals, const unsigned char* positions, size_t stride,
                                           size_t first, size_t count, float* PLIANT_RESTRICT out)
{
    float x[PLIANT_LANES] = { 0 }, y[PLIANT_LANES] = { 0 }, z[PLIANT_LANES] = { 0 };
    for (size_t i = 0; i < count; ++i) {
        const vector sum = sum_of_corners(normals, positions, stride, first + i);
        x[i] = sum.x;
        y[i] = sum.y;
        z[i] = sum.z;
    }
    normalise_lanes(x, y, z);
    for (size_t i = 0; i < PLIANT_LANES; ++i) {
        out[3 * i] = x[i];
        out[3 * i + 1] = y[i];
        out[3 * i + 2] = z[i];
    }
}

PLIANT_KERNEL(normals_of_block,
              (const pliant_normals* normals, const unsigned char* positions, size_t stride, size_t first, size_t count,
               float* PLIANT_RESTRICT out),
              (normals, positions, stride, first, count, out))
