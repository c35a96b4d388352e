/* Ties between the parts of a character, 16 at a time. Formula: formats/SPEC.md, kind 8.

   A tie is quadratic in the place of a vertex among its anchors, (r.e1, r.e2, r.(e1 x e2)), so that all poses together are
   one: see the combination of hinges in elements.c. As there, the place's change since z = 0 is formed from the changes of
   r, e1, e2 and nothing cancels. Loops are as in elements_shell.c: no branch, all values of a lane are scalars of the loop
   body. */
#include "internal.h"

#include <string.h>

typedef struct vector_t {
    float x, y, z;
} vector_t;

static PLIANT_INLINE vector_t read_vector(const float* rows, size_t stride)
{
    const vector_t v = { rows[0], rows[stride], rows[2 * stride] };
    return v;
}

static PLIANT_INLINE vector_t add(vector_t a, vector_t b)
{
    const vector_t v = { a.x + b.x, a.y + b.y, a.z + b.z };
    return v;
}

static PLIANT_INLINE float dot(vector_t a, vector_t b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static PLIANT_INLINE vector_t cross(vector_t a, vector_t b)
{
    const vector_t v = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
    return v;
}

/* s a + t b + u c */
static PLIANT_INLINE vector_t combine(float s, vector_t a, float t, vector_t b, float u, vector_t c)
{
    const vector_t v = { s * a.x + t * b.x + u * c.x, s * a.y + t * b.y + u * c.y, s * a.z + t * b.z + u * c.z };
    return v;
}

static PLIANT_INLINE void put_vector(pliant_lanes* out, size_t l, vector_t v)
{
    out[0][l] = v.x;
    out[1][l] = v.y;
    out[2][l] = v.z;
}

static PLIANT_INLINE void evaluate_tie(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                       float* PLIANT_RESTRICT energy)
{
    const float* rows = group->rows;
    const float* numbers = group->numbers;
    const float* change = group->change;
    const size_t s = group->stride, b = group->block_stride;
    pliant_lanes out[9];
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const vector_t r0 = read_vector(rows + l, s), p0 = read_vector(rows + 3 * s + l, s),
                       q0 = read_vector(rows + 6 * s + l, s);
        const vector_t dr = read_vector(change + l, b), dp = read_vector(change + 3 * b + l, b),
                       dq = read_vector(change + 6 * b + l, b);
        const vector_t r = add(r0, dr), p = add(p0, dp), q = add(q0, dq);
        const vector_t normal = cross(p, q), turned = add(cross(dp, q), cross(p0, dq)); /* the normal's change */
        const float g1 = dot(dr, p) + dot(r0, dp), g2 = dot(dr, q) + dot(r0, dq), g3 = dot(dr, normal) + dot(r0, turned);

        const float kappa = numbers[0 * s + l];
        const float t1 = numbers[1 * s + l], t2 = numbers[2 * s + l], t3 = numbers[3 * s + l];
        energy[l] += (g1 * (kappa * g1 + t1) + g2 * (kappa * g2 + t2)) + g3 * (kappa * g3 + t3);

        const float f1 = 2.0f * kappa * g1 + t1, f2 = 2.0f * kappa * g2 + t2, f3 = 2.0f * kappa * g3 + t3;
        const vector_t by_p = cross(q, r), by_q = cross(r, p); /* derivatives of r.(p x q) */
        put_vector(out, l, combine(f1, p, f2, q, f3, normal));
        put_vector(out + 3, l, combine(f1, r, f3, by_p, 0.0f, r));
        put_vector(out + 6, l, combine(f2, r, f3, by_q, 0.0f, r));
    }
    pliant_store_rows(force, b, out, 9);
}

PLIANT_KERNEL(evaluate_tie, (const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy),
              (group, force, energy))
