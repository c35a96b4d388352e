/* Elements of solids: two materials on linear tetrahedra, 16 at a time. Formulas: formats/SPEC.md, kinds 6 and 7.

   The rows are the deformation gradient F = I + D relative to z = 0, so that `change` is D and rows[0] is known: all that
   is the same for every shape at z = 0 is a constant here and no number of the file. Every term is formed from D and not
   from F: near z = 0, where blends are compared, nothing of the size of 1 is subtracted from its like.

   Loops are as in elements_shell.c: no branch, all values of a lane are scalars of the loop body. */
#include "internal.h"
#include "lane_math.h"

/* A matrix by its columns a, b, c. */
typedef struct matrix_t {
    float ax, ay, az, bx, by, bz, cx, cy, cz;
} matrix_t;

/* A symmetric one. */
typedef struct symmetric_t {
    float s11, s12, s13, s22, s23, s33;
} symmetric_t;

static PLIANT_INLINE matrix_t read_change(const float* change, size_t b, size_t l)
{
    const matrix_t d = {
        change[0 * b + l], change[1 * b + l], change[2 * b + l], change[3 * b + l], change[4 * b + l],
        change[5 * b + l], change[6 * b + l], change[7 * b + l], change[8 * b + l],
    };
    return d;
}

static PLIANT_INLINE symmetric_t read_symmetric(const float* numbers, size_t s, size_t l)
{
    const symmetric_t m = { numbers[0 * s + l], numbers[1 * s + l], numbers[2 * s + l],
                            numbers[3 * s + l], numbers[4 * s + l], numbers[5 * s + l] };
    return m;
}

/* D + D^T + D^T D, the change of the metric F^T F since z = 0. */
static PLIANT_INLINE symmetric_t measure_metric(matrix_t d)
{
    symmetric_t g;
    g.s11 = 2.0f * d.ax + (d.ax * d.ax + d.ay * d.ay + d.az * d.az);
    g.s12 = (d.bx + d.ay) + (d.ax * d.bx + d.ay * d.by + d.az * d.bz);
    g.s13 = (d.cx + d.az) + (d.ax * d.cx + d.ay * d.cy + d.az * d.cz);
    g.s22 = 2.0f * d.by + (d.bx * d.bx + d.by * d.by + d.bz * d.bz);
    g.s23 = (d.cy + d.bz) + (d.bx * d.cx + d.by * d.cy + d.bz * d.cz);
    g.s33 = 2.0f * d.cz + (d.cx * d.cx + d.cy * d.cy + d.cz * d.cz);
    return g;
}

/* The full contraction: what is beside the diagonal counts twice. */
static PLIANT_INLINE float contract(symmetric_t a, symmetric_t b)
{
    return (a.s11 * b.s11 + a.s22 * b.s22 + a.s33 * b.s33) + 2.0f * (a.s12 * b.s12 + a.s13 * b.s13 + a.s23 * b.s23);
}

/* Its columns are b x c, c x a, a x b. */
static PLIANT_INLINE matrix_t cofactor(matrix_t d)
{
    const matrix_t m = {
        d.by * d.cz - d.bz * d.cy, d.bz * d.cx - d.bx * d.cz, d.bx * d.cy - d.by * d.cx,
        d.cy * d.az - d.cz * d.ay, d.cz * d.ax - d.cx * d.az, d.cx * d.ay - d.cy * d.ax,
        d.ay * d.bz - d.az * d.by, d.az * d.bx - d.ax * d.bz, d.ax * d.by - d.ay * d.bx,
    };
    return m;
}

/* The derivative of b:cof(g) by g, which is linear in both: contracted with g it is twice b:cof(g). */
static PLIANT_INLINE symmetric_t polarise_cofactor(symmetric_t b, symmetric_t g)
{
    symmetric_t w;
    w.s11 = (b.s22 * g.s33 + b.s33 * g.s22) - 2.0f * (b.s23 * g.s23);
    w.s12 = (b.s13 * g.s23 + b.s23 * g.s13) - (b.s12 * g.s33 + b.s33 * g.s12);
    w.s13 = (b.s12 * g.s23 + b.s23 * g.s12) - (b.s13 * g.s22 + b.s22 * g.s13);
    w.s22 = (b.s11 * g.s33 + b.s33 * g.s11) - 2.0f * (b.s13 * g.s13);
    w.s23 = (b.s12 * g.s13 + b.s13 * g.s12) - (b.s11 * g.s23 + b.s23 * g.s11);
    w.s33 = (b.s11 * g.s22 + b.s22 * g.s11) - 2.0f * (b.s12 * g.s12);
    return w;
}

/* 2 F y for a symmetric y, F = I + d. */
static PLIANT_INLINE matrix_t twice_product(matrix_t d, symmetric_t y)
{
    const float ax = 1.0f + d.ax, by = 1.0f + d.by, cz = 1.0f + d.cz;
    const float y11 = 2.0f * y.s11, y12 = 2.0f * y.s12, y13 = 2.0f * y.s13;
    const float y22 = 2.0f * y.s22, y23 = 2.0f * y.s23, y33 = 2.0f * y.s33;
    const matrix_t p = {
        ax * y11 + d.bx * y12 + d.cx * y13, d.ay * y11 + by * y12 + d.cy * y13, d.az * y11 + d.bz * y12 + cz * y13,
        ax * y12 + d.bx * y22 + d.cx * y23, d.ay * y12 + by * y22 + d.cy * y23, d.az * y12 + d.bz * y22 + cz * y23,
        ax * y13 + d.bx * y23 + d.cx * y33, d.ay * y13 + by * y23 + d.cy * y33, d.az * y13 + d.bz * y23 + cz * y33,
    };
    return p;
}

static PLIANT_INLINE void put_force(pliant_lanes out[9], size_t l, matrix_t p)
{
    out[0][l] = p.ax;
    out[1][l] = p.ay;
    out[2][l] = p.az;
    out[3][l] = p.bx;
    out[4][l] = p.by;
    out[5][l] = p.bz;
    out[6][l] = p.cx;
    out[7][l] = p.cy;
    out[8][l] = p.cz;
}

/* St. Venant-Kirchhoff: a quadratic form in the metric. */
static PLIANT_INLINE void evaluate_tet_stvk(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                            float* PLIANT_RESTRICT energy)
{
    const float* numbers = group->numbers;
    const float* change = group->change;
    const size_t s = group->stride, b = group->block_stride;
    pliant_lanes out[9];
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const matrix_t d = read_change(change, b, l);
        const symmetric_t g = measure_metric(d);
        const symmetric_t linear = read_symmetric(numbers, s, l);
        const float* q = numbers + 6 * s + l; /* rows of the upper triangle: 6, 5, 4, 3, 2, 1 numbers */
        const float p11 = (q[0] * g.s11 + q[1 * s] * g.s12 + q[2 * s] * g.s13)
            + (q[3 * s] * g.s22 + q[4 * s] * g.s23 + q[5 * s] * g.s33);
        const float p12 = (q[1 * s] * g.s11 + q[6 * s] * g.s12 + q[7 * s] * g.s13)
            + (q[8 * s] * g.s22 + q[9 * s] * g.s23 + q[10 * s] * g.s33);
        const float p13 = (q[2 * s] * g.s11 + q[7 * s] * g.s12 + q[11 * s] * g.s13)
            + (q[12 * s] * g.s22 + q[13 * s] * g.s23 + q[14 * s] * g.s33);
        const float p22 = (q[3 * s] * g.s11 + q[8 * s] * g.s12 + q[12 * s] * g.s13)
            + (q[15 * s] * g.s22 + q[16 * s] * g.s23 + q[17 * s] * g.s33);
        const float p23 = (q[4 * s] * g.s11 + q[9 * s] * g.s12 + q[13 * s] * g.s13)
            + (q[16 * s] * g.s22 + q[18 * s] * g.s23 + q[19 * s] * g.s33);
        const float p33 = (q[5 * s] * g.s11 + q[10 * s] * g.s12 + q[14 * s] * g.s13)
            + (q[17 * s] * g.s22 + q[19 * s] * g.s23 + q[20 * s] * g.s33);
        energy[l]
            += ((linear.s11 + 0.5f * p11) * g.s11 + (linear.s12 + 0.5f * p12) * g.s12 + (linear.s13 + 0.5f * p13) * g.s13)
            + ((linear.s22 + 0.5f * p22) * g.s22 + (linear.s23 + 0.5f * p23) * g.s23 + (linear.s33 + 0.5f * p33) * g.s33);

        /* Entries beside the diagonal stand once in the vector of the metric and twice in its matrix. */
        const symmetric_t y = { linear.s11 + p11, 0.5f * (linear.s12 + p12), 0.5f * (linear.s13 + p13),
                                linear.s22 + p22, 0.5f * (linear.s23 + p23), linear.s33 + p33 };
        put_force(out, l, twice_product(d, y));
    }
    pliant_store_rows(force, b, out, 9);
}

/* Powers of s = 1 + u without what they are at u = 0, from the cube root k of s and t = k - 1: polynomials in t over powers
   of k, so that nothing cancels for small u. */
typedef struct powers_t {
    float first, second;             /* s^(-2/3) - 1, s^(-4/3) - 1 */
    float first_rest, second_rest;   /* the same plus 2/3 u, plus 4/3 u: of the order of u^2 */
    float first_slope, second_slope; /* derivatives of the first two by s */
    float first_rest_slope, second_rest_slope;
} powers_t;

static PLIANT_INLINE powers_t raise_powers(float u)
{
    powers_t p;
    const float k = pliant_cbrt(1.0f + u);
    const float square = k * k, fourth = square * square;
    const float t = u / (1.0f + k + square);
    const float inverse = 1.0f / k, inverse2 = inverse * inverse, inverse4 = inverse2 * inverse2;
    const float inverse5 = inverse4 * inverse, inverse7 = inverse5 * inverse2;
    const float sum5 = (fourth + k * square) + (square + k) + 1.0f; /* (k^5 - 1) / t */
    const float sum7 = (fourth * square + fourth * k) + sum5;       /* (k^7 - 1) / t */
    p.first = -t * (2.0f + t) * inverse2;
    p.second = p.first * (1.0f + square) * inverse2;
    p.first_rest = t * t * (((0.666666667f * t + 3.33333333f) * t + 6.66666667f) * t + 5.0f) * inverse2;
    p.second_rest = t * t
        * (((((1.33333333f * t + 9.33333333f) * t + 28.0f) * t + 44.3333333f) * t + 37.3333333f) * t + 14.0f) * inverse4;
    p.first_slope = -0.666666667f * inverse5;
    p.second_slope = -1.33333333f * inverse7;
    p.first_rest_slope = 0.666666667f * t * sum5 * inverse5;
    p.second_rest_slope = 1.33333333f * t * sum7 * inverse7;
    return p;
}

/* Mooney-Rivlin with a volume term: s^(-2/3) A:G + s^(-4/3) B:cof G + C s^2 - 2 (C - c) s for G = F^T F, s = det F, which
   every sum over poses of such energies is. Source: Ogden, "Non-linear Elastic Deformations", section 7.2; Bonet, Wood,
   "Nonlinear Continuum Mechanics for Finite Element Analysis", section 6.5, for the split into shape and volume. */
static PLIANT_INLINE void evaluate_tet_mooney_rivlin(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                                     float* PLIANT_RESTRICT energy)
{
    const float* numbers = group->numbers;
    const float* change = group->change;
    const size_t s = group->stride, b = group->block_stride;
    pliant_lanes out[9];
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const matrix_t d = read_change(change, b, l);
        const symmetric_t g = measure_metric(d);
        const symmetric_t linear = read_symmetric(numbers, s, l);
        const symmetric_t first = read_symmetric(numbers + 6 * s, s, l);
        const symmetric_t second = read_symmetric(numbers + 12 * s, s, l);
        const float volume = numbers[18 * s + l];
        const float a0 = first.s11 + first.s22 + first.s33, b0 = second.s11 + second.s22 + second.s33;
        const float rest_factor = 2.0f * numbers[19 * s + l] - (0.666666667f * a0 + 1.33333333f * b0);

        const matrix_t minors = cofactor(d);
        const float trace = d.ax + d.by + d.cz;
        const float higher = (minors.ax + minors.by + minors.cz) + (d.ax * minors.ax + d.ay * minors.ay + d.az * minors.az);
        const float u = trace + higher; /* det F - 1 */
        const float rest = higher
            - 0.5f
                * ((d.ax * d.ax + d.ay * d.ay + d.az * d.az) + (d.bx * d.bx + d.by * d.by + d.bz * d.bz)
                   + (d.cx * d.cx + d.cy * d.cy + d.cz * d.cz)); /* u - tr(g)/2 */
        /* Collapsed or turned inside out: infinite, so that the line search turns back. */
        const float wall = 1.0f + u > 0.0f ? 0.0f : INFINITY;

        const powers_t p = raise_powers(u);
        const symmetric_t turned = polarise_cofactor(second, g);
        const float first_g = contract(first, g), second_cofactor = 0.5f * contract(turned, g);
        const float second_h = (b0 * (g.s11 + g.s22 + g.s33) - contract(second, g)) + second_cofactor;
        energy[l] += ((contract(linear, g) + rest_factor * rest) + (p.first * first_g + p.second * second_h))
            + ((a0 * p.first_rest + b0 * p.second_rest) + (second_cofactor + volume * u * u)) + wall;

        const float one = 1.0f + p.second;
        const symmetric_t y = {
            (linear.s11 + p.first * first.s11) + (p.second * (b0 - second.s11) + one * turned.s11),
            (linear.s12 + p.first * first.s12) + (one * turned.s12 - p.second * second.s12),
            (linear.s13 + p.first * first.s13) + (one * turned.s13 - p.second * second.s13),
            (linear.s22 + p.first * first.s22) + (p.second * (b0 - second.s22) + one * turned.s22),
            (linear.s23 + p.first * first.s23) + (one * turned.s23 - p.second * second.s23),
            (linear.s33 + p.first * first.s33) + (p.second * (b0 - second.s33) + one * turned.s33),
        };
        matrix_t f = twice_product(d, y);
        /* By the determinant: pressure * cof F, and rest_factor * (cof F - F), where cof F = I + (tr(D) I - D^T) + cof D. */
        const float pressure = (p.first_slope * first_g + p.second_slope * second_h)
            + (a0 * p.first_rest_slope + b0 * p.second_rest_slope + 2.0f * volume * u);
        const float both = pressure + rest_factor;
        f.ax += pressure * (1.0f + (trace - d.ax)) + rest_factor * (trace - (d.ax + d.ax)) + both * minors.ax;
        f.ay += both * (minors.ay - d.bx) - rest_factor * d.ay;
        f.az += both * (minors.az - d.cx) - rest_factor * d.az;
        f.bx += both * (minors.bx - d.ay) - rest_factor * d.bx;
        f.by += pressure * (1.0f + (trace - d.by)) + rest_factor * (trace - (d.by + d.by)) + both * minors.by;
        f.bz += both * (minors.bz - d.cy) - rest_factor * d.bz;
        f.cx += both * (minors.cx - d.az) - rest_factor * d.cx;
        f.cy += both * (minors.cy - d.bz) - rest_factor * d.cy;
        f.cz += pressure * (1.0f + (trace - d.cz)) + rest_factor * (trace - (d.cz + d.cz)) + both * minors.cz;
        put_force(out, l, f);
    }
    pliant_store_rows(force, b, out, 9);
}

PLIANT_KERNEL(evaluate_tet_stvk,
              (const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy),
              (group, force, energy))
PLIANT_KERNEL(evaluate_tet_mooney_rivlin,
              (const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy),
              (group, force, energy))
