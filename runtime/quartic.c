/* The surrogate energy as a quartic polynomial per pose, formats/SPEC.md section 4, QUAR: what St. Venant-Kirchhoff solids
   are exactly, in O(d^4) for any number of tetrahedra.

   The polynomial is a quadratic form in the products phi_t = x_a x_b of pairs t of x = (1, z), which is evaluated by its
   rows: row (i, j) holds what x_i x_j is multiplied with, for the pairs that do not come before (j, j). One pass over the
   table gives both the sums <row, phi> and psi, the derivatives by phi. Source of the idea: Barbic, James, "Real-Time
   Subspace Integration for St. Venant-Kirchhoff Deformable Models", SIGGRAPH 2005, section 4, who store the gradient's cubic
   polynomials. */
#include "internal.h"
#include "linalg.h"

/* Sums run over this many lanes: with four rows at a time their sums fill the registers of AVX2. */
#define SUM_LANES PLIANT_FORMAT_QUARTIC_LANES

/* Rows that share a trip of phi and psi to the cache. */
#define GROUP 4u

typedef float sums_t[SUM_LANES];

static PLIANT_INLINE float add_lanes(const float* lanes)
{
    float half[4];
    for (int i = 0; i < 4; ++i) half[i] = lanes[i] + lanes[i + 4];
    return (half[0] + half[2]) + (half[1] + half[3]);
}

/* Pieces of the scratch: x (padded), the pairs' products, the derivatives by them, and by each of x a sum in lanes. */
typedef struct quartic_view {
    size_t size;     /* N = d + 1 */
    size_t pair_end; /* of phi, psi and every row, in floats */
    float* x;
    float* phi;
    float* psi;
    float* slopes; /* N times SUM_LANES */
} quartic_view;

static PLIANT_INLINE size_t pair_floats(uint32_t dimension)
{
    return pliant_pad_lanes(pliant_format_quartic_row_end(dimension));
}

static PLIANT_INLINE quartic_view view_scratch(uint32_t dimension, float* scratch)
{
    quartic_view v;
    v.size = (size_t)dimension + 1;
    v.pair_end = pliant_format_quartic_row_end(dimension);
    v.x = scratch;
    v.phi = v.x + pliant_pad_lanes(v.size);
    v.psi = v.phi + pair_floats(dimension);
    v.slopes = v.psi + pair_floats(dimension);
    return v;
}

pliant_energy_layout pliant_quartic_measure(const pliant_asset* asset)
{
    const uint32_t d = asset->dimension;
    const size_t size = (size_t)d + 1;
    pliant_energy_layout layout;
    layout.combined_floats = asset->quartic_floats;
    layout.scratch_floats = pliant_pad_lanes(size) + 2 * pair_floats(d) + pliant_pad_lanes(size * SUM_LANES);
    return layout;
}

void pliant_quartic_combine(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights, float* combined)
{
    kernels->combine_columns(combined, asset->quartic, weights, asset->pose_count, asset->quartic_floats);
}

static PLIANT_INLINE void multiply_pairs(const quartic_view* v)
{
    float* PLIANT_RESTRICT phi = v->phi;
    for (size_t a = 0; a < v->size; ++a) {
        const float* x = v->x + a;
        for (size_t b = 0; b < v->size - a; ++b) phi[b] = x[0] * x[b];
        phi += v->size - a;
    }
    memset(phi, 0, (size_t)(v->phi + v->pair_end - phi) * sizeof *phi);
}

/* slope += factor * s. All is read before anything is written: a compiler that cannot rule out that they overlap makes
   vector code of that, too. */
static PLIANT_INLINE void add_to_slope(float* slope, float factor, const float* s)
{
    sums_t sum;
    for (size_t l = 0; l < SUM_LANES; ++l) sum[l] = slope[l] + factor * s[l];
    memcpy(slope, sum, sizeof sum);
}

/* One row (i, j) of `count` floats: with s = <row, phi> psi += x_i x_j row, slope += x_j s, block += x_i s. */
static PLIANT_INLINE void pass_row(const float* PLIANT_RESTRICT row, const float* PLIANT_RESTRICT phi,
                                   float* PLIANT_RESTRICT psi, size_t count, float xi, float xj,
                                   float* PLIANT_RESTRICT slope, float* PLIANT_RESTRICT block)
{
    const float factor = xi * xj;
    sums_t s = { 0 };
    for (size_t t = 0; t < count; t += SUM_LANES)
        for (size_t l = 0; l < SUM_LANES; ++l) {
            s[l] += row[t + l] * phi[t + l];
            psi[t + l] += factor * row[t + l];
        }
    for (size_t l = 0; l < SUM_LANES; ++l) block[l] += xi * s[l];
    add_to_slope(slope, xj, s);
}

/* The same for GROUP rows (i, j), (i+1, j), .. that lie one after the other; x holds x_i, x_(i+1), .. */
static PLIANT_INLINE void pass_rows(const float* PLIANT_RESTRICT row, const float* PLIANT_RESTRICT phi,
                                    float* PLIANT_RESTRICT psi, size_t count, const float* x, float xj,
                                    float* PLIANT_RESTRICT slopes, float* PLIANT_RESTRICT block)
{
    const float x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3];
    const float f0 = x0 * xj, f1 = x1 * xj, f2 = x2 * xj, f3 = x3 * xj;
    const float* r1 = row + count;
    const float* r2 = r1 + count;
    const float* r3 = r2 + count;
    sums_t s0 = { 0 }, s1 = { 0 }, s2 = { 0 }, s3 = { 0 };
    for (size_t t = 0; t < count; t += SUM_LANES)
        for (size_t l = 0; l < SUM_LANES; ++l) {
            const float p = phi[t + l];
            const float c0 = row[t + l], c1 = r1[t + l], c2 = r2[t + l], c3 = r3[t + l];
            s0[l] += c0 * p;
            s1[l] += c1 * p;
            s2[l] += c2 * p;
            s3[l] += c3 * p;
            psi[t + l] += (f0 * c0 + f1 * c1) + (f2 * c2 + f3 * c3);
        }
    for (size_t l = 0; l < SUM_LANES; ++l) block[l] += (x0 * s0[l] + x1 * s1[l]) + (x2 * s2[l] + x3 * s3[l]);
    add_to_slope(slopes, xj, s0);
    add_to_slope(slopes + SUM_LANES, xj, s1);
    add_to_slope(slopes + 2 * SUM_LANES, xj, s2);
    add_to_slope(slopes + 3 * SUM_LANES, xj, s3);
}

/* The rows (0, j) .. (j, j), `count` floats each: psi, what they add to the slopes, and their part of the value, which is
   added up in double as that of a batch of elements is. */
static PLIANT_INLINE double pass_block(const quartic_view* v, const float* row, size_t j, size_t count)
{
    const float* phi = v->phi + (v->pair_end - count);
    float* psi = v->psi + (v->pair_end - count);
    const float xj = v->x[j];
    sums_t block = { 0 }; /* sum over i of x_i s_ij: the derivative by x_j */
    size_t i = 0;
    for (; i + GROUP <= j + 1; i += GROUP, row += GROUP * count)
        pass_rows(row, phi, psi, count, v->x + i, xj, v->slopes + i * SUM_LANES, block);
    for (; i <= j; ++i, row += count) pass_row(row, phi, psi, count, v->x[i], xj, v->slopes + i * SUM_LANES, block);
    pliant_add_scaled(v->slopes + j * SUM_LANES, 1.0f, block, SUM_LANES);
    return (double)xj * (double)add_lanes(block);
}

/* <a, b> added to the lanes of `slope`: their sum. */
static PLIANT_INLINE float finish_slope(const float* PLIANT_RESTRICT a, const float* PLIANT_RESTRICT b, size_t count,
                                        const float* slope)
{
    sums_t sum;
    size_t t = 0;
    memcpy(sum, slope, sizeof sum);
    for (; t + SUM_LANES <= count; t += SUM_LANES)
        for (size_t l = 0; l < SUM_LANES; ++l) sum[l] += a[t + l] * b[t + l];
    for (size_t l = 0; t + l < count; ++l) sum[l] += a[t + l] * b[t + l];
    return add_lanes(sum);
}

/* The gradient by the product rule, from psi: pair (a, b) adds psi x_b to the derivative by x_a and psi x_a to that by x_b.
   That by x_0 = 1 is nobody's. */
static PLIANT_INLINE void add_pair_slopes(const quartic_view* v, float* gradient)
{
    const float* psi = v->psi;
    pliant_add_scaled(gradient, 1.0f, psi + 1, v->size - 1);
    psi += v->size;
    for (size_t a = 1; a < v->size; ++a) {
        const float* x = v->x + a;
        const size_t count = v->size - a;
        pliant_add_scaled(gradient + (a - 1), x[0], psi, count);
        gradient[a - 1] += finish_slope(psi, x, count, v->slopes + a * SUM_LANES);
        psi += count;
    }
}

static PLIANT_INLINE void evaluate_quartic(uint32_t dimension, const float* table, const float* z,
                                           float* PLIANT_RESTRICT gradient, float* scratch, double* energy)
{
    const quartic_view v = view_scratch(dimension, scratch);
    double total = 0.0;
    v.x[0] = 1.0f;
    memcpy(v.x + 1, z, dimension * sizeof *z);
    multiply_pairs(&v);
    memset(v.psi, 0, v.pair_end * sizeof *v.psi);
    memset(v.slopes, 0, v.size * sizeof(sums_t));
    memset(gradient, 0, pliant_pad_lanes(dimension) * sizeof *gradient);
    for (uint32_t j = 0; j <= dimension; ++j) {
        const size_t count = v.pair_end - pliant_format_quartic_row_start(dimension, j);
        total += pass_block(&v, table, j, count);
        table += (j + 1) * count;
    }
    add_pair_slopes(&v, gradient);
    *energy = total;
}

PLIANT_KERNEL(evaluate_quartic,
              (uint32_t dimension, const float* table, const float* z, float* PLIANT_RESTRICT gradient, float* scratch,
               double* energy),
              (dimension, table, z, gradient, scratch, energy))

double pliant_quartic_evaluate(const pliant_kernels* kernels, const pliant_asset* asset, const float* combined,
                               const float* z, float* gradient, float* scratch)
{
    double energy;
    kernels->evaluate_quartic(asset->dimension, combined, z, gradient, scratch, &energy);
    return energy;
}
