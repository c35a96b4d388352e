/* Elements of thin shells: the hinge and three kinds of faces, 16 at a time. Formulas: formats/SPEC.md, kinds 1 to 4.

   Every loop runs over the lanes of one group without a branch, so that a compiler turns it into vector code; all
   values of a lane are scalars of the loop body. Forces are derivatives by the difference vectors. They are collected on the
   stack: rows at a distance that is known only at run time would look to a compiler as if they might overlap. */
#include "internal.h"
#include "lane_math.h"

/* Discrete Shells: Grinspun, Hirani, Desbrun, Schroeder, "Discrete Shells", SCA 2003. */
static PLIANT_INLINE void evaluate_hinge(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                         float* PLIANT_RESTRICT energy)
{
    const float* rows = group->rows;
    const float* fixed = group->fixed;
    const float* numbers = group->numbers;
    const float* change = group->change;
    const size_t s = group->stride, b = group->block_stride;
    pliant_lanes out[9];
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float ex = rows[0 * s + l] + change[0 * b + l];
        const float ey = rows[1 * s + l] + change[1 * b + l];
        const float ez = rows[2 * s + l] + change[2 * b + l];
        const float ax = rows[3 * s + l] + change[3 * b + l];
        const float ay = rows[4 * s + l] + change[4 * b + l];
        const float az = rows[5 * s + l] + change[5 * b + l];
        const float bx = rows[6 * s + l] + change[6 * b + l];
        const float by = rows[7 * s + l] + change[7 * b + l];
        const float bz = rows[8 * s + l] + change[8 * b + l];

        /* With the unit edge h instead of e the normals are lengths and not areas (times two): powers stay small whatever
           unit the mesh is in. e.(N1 x N2) = -|e|^2 det(h, a, b) needs no second cross product. */
        const float edge_inverse = 1.0f / sqrtf(ex * ex + ey * ey + ez * ez);
        const float hx = ex * edge_inverse, hy = ey * edge_inverse, hz = ez * edge_inverse;
        const float n1x = hy * az - hz * ay, n1y = hz * ax - hx * az, n1z = hx * ay - hy * ax;
        const float n2x = by * hz - bz * hy, n2y = bz * hx - bx * hz, n2z = bx * hy - by * hx;
        const float sine = -(n1x * bx + n1y * by + n1z * bz);
        const float cosine = n1x * n2x + n1y * n2y + n1z * n2z;
        const float theta = pliant_atan2(sine, cosine);

        const float beta = numbers[0 * s + l], gamma = numbers[1 * s + l];
        const float t = pliant_wrap_angle(theta - fixed[0 * s + l]), t0 = fixed[1 * s + l];
        const float torque = 2.0f * (beta * t - gamma);
        energy[l] += (t - t0) * (beta * (t + t0) - 2.0f * gamma);

        /* dtheta/da = -n1/|n1|^2, dtheta/db = -n2/|n2|^2, dtheta/de follows as turning the body changes no angle. */
        const float f1 = torque / (n1x * n1x + n1y * n1y + n1z * n1z);
        const float f2 = torque / (n2x * n2x + n2y * n2y + n2z * n2z);
        const float e1 = f1 * ((ax * hx + ay * hy + az * hz) * edge_inverse);
        const float e2 = f2 * ((bx * hx + by * hy + bz * hz) * edge_inverse);
        out[0][l] = e1 * n1x + e2 * n2x;
        out[1][l] = e1 * n1y + e2 * n2y;
        out[2][l] = e1 * n1z + e2 * n2z;
        out[3][l] = -f1 * n1x;
        out[4][l] = -f1 * n1y;
        out[5][l] = -f1 * n1z;
        out[6][l] = -f2 * n2x;
        out[7][l] = -f2 * n2y;
        out[8][l] = -f2 * n2z;
    }
    pliant_store_rows(force, b, out, 9);
}

/* What the three kinds of faces share: the differences now and the change of the metric since z = 0, formed from the changes
   of the differences without cancellation. */
typedef struct face_metric {
    float ex, ey, ez, ax, ay, az;
    float g11, g12, g22; /* change of the metric */
    float det;           /* g11 g22 - g12^2 */
} face_metric;

static PLIANT_INLINE face_metric measure_face(const float* rows, const float* change, size_t s, size_t b, size_t l)
{
    const float e0x = rows[0 * s + l], e0y = rows[1 * s + l], e0z = rows[2 * s + l];
    const float a0x = rows[3 * s + l], a0y = rows[4 * s + l], a0z = rows[5 * s + l];
    const float dex = change[0 * b + l], dey = change[1 * b + l], dez = change[2 * b + l];
    const float dax = change[3 * b + l], day = change[4 * b + l], daz = change[5 * b + l];
    face_metric m;
    m.ex = e0x + dex;
    m.ey = e0y + dey;
    m.ez = e0z + dez;
    m.ax = a0x + dax;
    m.ay = a0y + day;
    m.az = a0z + daz;
    m.g11 = (m.ex + e0x) * dex + (m.ey + e0y) * dey + (m.ez + e0z) * dez;
    m.g22 = (m.ax + a0x) * dax + (m.ay + a0y) * day + (m.az + a0z) * daz;
    m.g12 = (dex * m.ax + dey * m.ay + dez * m.az) + (e0x * dax + e0y * day + e0z * daz);
    m.det = m.g11 * m.g22 - m.g12 * m.g12;
    return m;
}

/* Forces from the derivatives of the energy by g11, g12, g22. */
static PLIANT_INLINE void write_face_force(pliant_lanes out[6], size_t l, face_metric m, float f11, float f12, float f22)
{
    const float ee = 2.0f * f11, aa = 2.0f * f22;
    out[0][l] = ee * m.ex + f12 * m.ax;
    out[1][l] = ee * m.ey + f12 * m.ay;
    out[2][l] = ee * m.ez + f12 * m.az;
    out[3][l] = f12 * m.ex + aa * m.ax;
    out[4][l] = f12 * m.ey + aa * m.ay;
    out[5][l] = f12 * m.ez + aa * m.az;
}

/* Compressible neo-Hookean membrane: W of Heeren et al., "Splines in the Space of Shells", SGP 2016, eq. 4. */
static PLIANT_INLINE void evaluate_face_neo_hookean(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                                    float* PLIANT_RESTRICT energy)
{
    const float* fixed = group->fixed;
    const float* numbers = group->numbers;
    const float* rows = group->rows;
    const float* change = group->change;
    const size_t s = group->stride, b = group->block_stride;
    pliant_lanes out[6];
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const face_metric m = measure_face(rows, change, s, b, l);
        const float i11 = fixed[0 * s + l], i12 = fixed[1 * s + l], i22 = fixed[2 * s + l], r = fixed[3 * s + l];
        const float l11 = numbers[0 * s + l], l12 = numbers[1 * s + l], l22 = numbers[2 * s + l];
        const float area = numbers[3 * s + l], barrier = numbers[4 * s + l];

        const float u = (i11 * m.g11 + 2.0f * i12 * m.g12 + i22 * m.g22) + r * m.det;
        /* A triangle that has collapsed or, by rounding, more than that: infinite, so that the line search turns back. */
        const float wall = 1.0f + u > 0.0f ? 0.0f : INFINITY;
        energy[l] += ((l11 * m.g11 + l12 * m.g12 + l22 * m.g22) + (area * m.det - barrier * pliant_log1p_minus(u))) + wall;

        const float h = barrier * u / (1.0f + u); /* -P d(log(1+u) - u)/du */
        const float f11 = (l11 + area * m.g22) + h * (i11 + r * m.g22);
        const float f22 = (l22 + area * m.g11) + h * (i22 + r * m.g11);
        const float f12 = (l12 - 2.0f * area * m.g12) + 2.0f * h * (i12 - r * m.g12);
        write_face_force(out, l, m, f11, f12, f22);
    }
    pliant_store_rows(force, b, out, 6);
}

/* St. Venant-Kirchhoff membrane: a quadratic form in the metric. */
static PLIANT_INLINE void evaluate_face_stvk(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                             float* PLIANT_RESTRICT energy)
{
    const float* numbers = group->numbers;
    const float* rows = group->rows;
    const float* change = group->change;
    const size_t s = group->stride, b = group->block_stride;
    pliant_lanes out[6];
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const face_metric m = measure_face(rows, change, s, b, l);
        const float l11 = numbers[0 * s + l], l12 = numbers[1 * s + l], l22 = numbers[2 * s + l];
        const float q00 = numbers[3 * s + l], q01 = numbers[4 * s + l], q02 = numbers[5 * s + l];
        const float q11 = numbers[6 * s + l], q12 = numbers[7 * s + l], q22 = numbers[8 * s + l];
        const float p11 = q00 * m.g11 + q01 * m.g12 + q02 * m.g22;
        const float p12 = q01 * m.g11 + q11 * m.g12 + q12 * m.g22;
        const float p22 = q02 * m.g11 + q12 * m.g12 + q22 * m.g22;
        energy[l] += (l11 + 0.5f * p11) * m.g11 + (l12 + 0.5f * p12) * m.g12 + (l22 + 0.5f * p22) * m.g22;
        write_face_force(out, l, m, l11 + p11, l12 + p12, l22 + p22);
    }
    pliant_store_rows(force, b, out, 6);
}

/* One length of the edge-and-area membrane: adds its energy, returns the derivative by the square of the length. `square` is
   the length's square now, `grown` its change since z = 0: l - l0 = grown / (l + l0) has no cancellation. */
static PLIANT_INLINE float evaluate_length(float square, float grown, float start, float c, float target, float* energy)
{
    const float length = sqrtf(square);
    *energy += c * grown - 2.0f * target * (grown / (length + start));
    return c - target / length;
}

/* Edge lengths and areas as springs. */
static PLIANT_INLINE void evaluate_face_edge(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                             float* PLIANT_RESTRICT energy)
{
    const float* fixed = group->fixed;
    const float* numbers = group->numbers;
    const float* rows = group->rows;
    const float* change = group->change;
    const size_t s = group->stride, b = group->block_stride;
    pliant_lanes out[6];
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const face_metric m = measure_face(rows, change, s, b, l);
        const float g11 = m.ex * m.ex + m.ey * m.ey + m.ez * m.ez;
        const float g22 = m.ax * m.ax + m.ay * m.ay + m.az * m.az;
        const float g12 = m.ex * m.ax + m.ey * m.ay + m.ez * m.az;
        const float dx = m.ax - m.ex, dy = m.ay - m.ey, dz = m.az - m.ez;
        const float nx = m.ey * m.az - m.ez * m.ay, ny = m.ez * m.ax - m.ex * m.az, nz = m.ex * m.ay - m.ey * m.ax;
        const float opposite_grown = (m.g11 + m.g22) - 2.0f * m.g12;
        /* det G - det G0 with G0 = G - g */
        const float det_grown = (g22 * m.g11 + g11 * m.g22 - 2.0f * g12 * m.g12) - m.det;

        float sum = 0.0f;
        const float h1 = evaluate_length(g11, m.g11, fixed[0 * s + l], numbers[0 * s + l], numbers[1 * s + l], &sum);
        const float h2 = evaluate_length(g22, m.g22, fixed[1 * s + l], numbers[2 * s + l], numbers[3 * s + l], &sum);
        const float h3 = evaluate_length(dx * dx + dy * dy + dz * dz, opposite_grown, fixed[2 * s + l], numbers[4 * s + l],
                                         numbers[5 * s + l], &sum);
        const float h4 = evaluate_length(0.25f * (nx * nx + ny * ny + nz * nz), 0.25f * det_grown, fixed[3 * s + l],
                                         numbers[6 * s + l], numbers[7 * s + l], &sum);
        energy[l] += sum;
        write_face_force(out, l, m, h1 + h3 + 0.25f * h4 * g22, -2.0f * h3 - 0.5f * h4 * g12, h2 + h3 + 0.25f * h4 * g11);
    }
    pliant_store_rows(force, b, out, 6);
}

PLIANT_KERNEL(evaluate_hinge,
              (const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy),
              (group, force, energy))
PLIANT_KERNEL(evaluate_face_neo_hookean,
              (const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy),
              (group, force, energy))
PLIANT_KERNEL(evaluate_face_stvk,
              (const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy),
              (group, force, energy))
PLIANT_KERNEL(evaluate_face_edge,
              (const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy),
              (group, force, energy))
