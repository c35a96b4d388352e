/* Tetrahedra by themselves: the kernels of kinds 6 and 7 against the plain formulas in double precision, from deformations
   of 1e-5 to large ones, where formulas that subtract numbers of size 1 would lose their digits; infinite where a
   tetrahedron has collapsed or is turned inside out. */
#include "internal.h"
#include "support.h"

#include <math.h>

enum { ROWS = 9, MOST_NUMBERS = 27 };

static const int place[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };

typedef struct group {
    float change[ROWS][PLIANT_LANES];
    float numbers[MOST_NUMBERS][PLIANT_LANES];
    float force[ROWS][PLIANT_LANES];
    float energy[PLIANT_LANES];
} group;

static void evaluate(pliant_element_kernel* kernel, group* g)
{
    const pliant_element_group view = { NULL, NULL, g->numbers[0], PLIANT_LANES, g->change[0], PLIANT_LANES };
    memset(g->energy, 0, sizeof g->energy);
    kernel(&view, g->force[0], g->energy);
}

static double determinant(double m[3][3])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* metric = D + D^T + D^T D */
static void measure(double d[3][3], double metric[3][3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            metric[i][j] = d[i][j] + d[j][i] + d[0][i] * d[0][j] + d[1][i] * d[1][j] + d[2][i] * d[2][j];
}

/* The energies of formats/SPEC.md. *size becomes that of its terms, which the error is measured against. */
static double stvk(const double* number, double d[3][3], double* size)
{
    double metric[3][3], g[6], value = 0.0;
    const double* q = number + 6;
    measure(d, metric);
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) g[place[i][j]] = metric[i][j];
    *size = 0.0;
    for (int a = 0; a < 6; ++a) {
        value += number[a] * g[a];
        *size += fabs(number[a] * g[a]);
        for (int b = a; b < 6; ++b, ++q) value += *q * g[a] * g[b] * (a == b ? 0.5 : 1.0);
    }
    return value;
}

static double mooney_rivlin(const double* number, double d[3][3], double* size)
{
    double g[3][3], f[3][3], cofactor[3][3], linear = 0.0, a_g = 0.0, b_h = 0.0, b_cofactor = 0.0;
    const double *a = number + 6, *b = number + 12;
    measure(d, g);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            f[i][j] = d[i][j] + (i == j);
            cofactor[i][j] = g[i1][j1] * g[i2][j2] - g[i1][j2] * g[i2][j1];
        }
    *size = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int p = place[i][j];
            linear += number[p] * g[i][j];
            a_g += a[p] * g[i][j];
            b_h += b[p] * ((i == j ? g[0][0] + g[1][1] + g[2][2] : 0.0) - g[i][j] + cofactor[i][j]);
            b_cofactor += b[p] * cofactor[i][j];
            *size += fabs(number[p] * g[i][j]);
        }
    const double u = determinant(f) - 1.0, s1 = pow(1.0 + u, -2.0 / 3.0), s2 = pow(1.0 + u, -4.0 / 3.0);
    const double a0 = a[0] + a[3] + a[5], b0 = b[0] + b[3] + b[5];
    const double rest = u - (g[0][0] + g[1][1] + g[2][2]) / 2.0;
    return linear + (s1 - 1.0) * a_g + a0 * (s1 - 1.0 + 2.0 / 3.0 * u) + (s2 - 1.0) * b_h + b_cofactor
        + b0 * (s2 - 1.0 + 4.0 / 3.0 * u) + (2.0 * number[19] - 2.0 / 3.0 * a0 - 4.0 / 3.0 * b0) * rest + number[18] * u * u;
}

typedef double energy_function(const double* number, double d[3][3], double* size);

/* L is left out every other round: what remains is of second order and must be right to as many digits. */
static void check(const char* name, pliant_element_kernel* kernel, energy_function* exact)
{
    uint64_t state = 67;
    double worst = 0.0, worst_force = 0.0;
    for (int round = 0; round < 4000; ++round) {
        group g;
        const float size = powf(10.0f, -(float)(round % 5) - 0.5f);
        for (int i = 0; i < MOST_NUMBERS; ++i)
            for (int l = 0; l < (int)PLIANT_LANES; ++l)
                g.numbers[i][l] = i < 6 && round % 2 ? 0.0f : random_unit(&state) - (i < 18 ? 0.5f : 0.0f);
        for (int r = 0; r < ROWS; ++r)
            for (int l = 0; l < (int)PLIANT_LANES; ++l) g.change[r][l] = size * (random_unit(&state) - 0.5f);
        evaluate(kernel, &g);
        const int l = round % (int)PLIANT_LANES;
        double d[3][3], number[MOST_NUMBERS], terms, unused;
        for (int r = 0; r < ROWS; ++r) d[r % 3][r / 3] = (double)g.change[r][l];
        for (int i = 0; i < MOST_NUMBERS; ++i) number[i] = (double)g.numbers[i][l];
        const double value = exact(number, d, &terms), square = 9.0 * (double)(size * size);
        const double error = fabs((double)g.energy[l] - value) / (terms + square);
        if (error > worst) worst = error;
        /* Central differences in double: the third derivative leaves step^2, rounding 1e-16 / step. */
        for (int r = 0; r < ROWS; ++r) {
            const double step = 1e-6 + 1e-4 * (double)size, start = d[r % 3][r / 3];
            d[r % 3][r / 3] = start + step;
            const double ahead = exact(number, d, &unused);
            d[r % 3][r / 3] = start - step;
            const double slope = (ahead - exact(number, d, &unused)) / (2.0 * step);
            d[r % 3][r / 3] = start;
            const double off = fabs(slope - (double)g.force[r][l]) / (terms / (double)size + 9.0 * (double)size);
            if (off > worst_force) worst_force = off;
        }
    }
    printf("%s: energy to %.2g, forces to %.2g\n", name, worst, worst_force);
    CHECK(worst < 2e-6, "%s: energy off by %.3g of its terms", name, worst);
    CHECK(worst_force < 1e-5, "%s: a force off by %.3g", name, worst_force);
}

/* Nothing moves: nothing may be there. And a wall where the determinant vanishes. */
static void check_ends(void)
{
    static const float columns[4][3] = { { 0, 0, 0 }, { -1, 0, 0 }, { -2, 0, 0 }, { -0.999f, 0, 0 } };
    for (int i = 0; i < 4; ++i) {
        group g;
        memset(&g, 0, sizeof g);
        for (int p = 6; p < 20; ++p)
            for (int l = 0; l < (int)PLIANT_LANES; ++l) g.numbers[p][l] = p == 6 || p == 9 || p == 11 ? 1.0f : 0.1f;
        for (int r = 0; r < 3; ++r)
            for (int l = 0; l < (int)PLIANT_LANES; ++l) g.change[r][l] = columns[i][r];
        evaluate(pliant_kernels_plain.evaluate_tet_mooney_rivlin, &g);
        CHECK(pliant_is_finite(g.energy[0]) == (i == 0 || i == 3), "column %d: energy %g", i, (double)g.energy[0]);
        CHECK(i > 0 || g.energy[0] == 0.0f, "energy %g without deformation", (double)g.energy[0]);
    }
}

int main(void)
{
    check("St. Venant-Kirchhoff", pliant_kernels_plain.evaluate_tet_stvk, stvk);
    check("Mooney-Rivlin", pliant_kernels_plain.evaluate_tet_mooney_rivlin, mooney_rivlin);
    check_ends();
    return report("solids");
}
