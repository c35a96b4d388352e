/* The ARAP cell (spokes and rims), 16 at a time. Formula: formats/SPEC.md, kind 5.

   The rotation R that maximises tr(R^T M) is the eigenvector, a quaternion, of the largest eigenvalue of Horn's symmetric
   4x4 matrix of M (Horn, "Closed-form solution of absolute orientation using unit quaternions", JOSA A 1987): the sign of
   det M, repeated and vanishing singular values need no cases. Where the two largest eigenvalues nearly meet (M nearly a
   mirror image with equal singular values, or nearly of rank one) the maximum is flat, and R keeps fewer digits. The
   eigenvalue is the largest root of a quartic, the eigenvector a column of an adjugate (Theobald, "Rapid calculation of
   RMSDs using a quaternion-based characteristic polynomial", Acta Crystallographica A 2005). That leaves some digits;
   Newton's method on rotations adds the others. No step branches over the lanes.

   Energy: Sorkine, Alexa, "As-Rigid-As-Possible Surface Modeling", SGP 2007; spokes and rims: Chao, Pinkall, Sanan,
   Schroeder, "A Simple Geometric Model for Elastic Deformations", SIGGRAPH 2010. */
#include "internal.h"
#include "lane_math.h"

/* From the bound the root is at most a factor of 1.74 away: every step halves the distance at least, and doubles the digits
   where the second one is far. */
#define EIGENVALUE_STEPS 11

/* From three digits: six, twelve. */
#define ROTATION_STEPS 2

/* Energies of a cell are differences of numbers of the size of c |edge|^2, a hundred to ten thousand times larger. What
   enters them (moments, rotations, sums) is therefore formed in double precision; forces do not cancel and stay single. */
typedef double wide_t[PLIANT_LANES];

/* M of norm 1. */
static PLIANT_INLINE void scale_moments(wide_t moments[9], wide_t scaled[9])
{
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        double square = 0.0;
        for (int i = 0; i < 9; ++i) square += moments[i][l] * moments[i][l];
        const double scale = 1.0 / sqrt(square > 1e-200 ? square : 1.0);
        for (int i = 0; i < 9; ++i) scaled[i][l] = moments[i][l] * scale;
    }
}

/* Horn's matrix of M, the upper triangle by rows: 00 01 02 03 11 12 13 22 23 33. */
static PLIANT_INLINE void make_horn_matrix(wide_t m[9], pliant_lanes k[10])
{
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float xx = (float)m[0][l], xy = (float)m[1][l], xz = (float)m[2][l];
        const float yx = (float)m[3][l], yy = (float)m[4][l], yz = (float)m[5][l];
        const float zx = (float)m[6][l], zy = (float)m[7][l], zz = (float)m[8][l];
        k[0][l] = xx + yy + zz;
        k[1][l] = zy - yz;
        k[2][l] = xz - zx;
        k[3][l] = yx - xy;
        k[4][l] = xx - yy - zz;
        k[5][l] = xy + yx;
        k[6][l] = xz + zx;
        k[7][l] = yy - xx - zz;
        k[8][l] = yz + zy;
        k[9][l] = zz - xx - yy;
    }
}

/* The largest root of x^4 - 2 |M|^2 x^2 - 8 det M x + det K. Newton's method comes down to it from the bound sqrt(3) |M|. */
static PLIANT_INLINE void find_eigenvalue(wide_t m[9], wide_t x)
{
    wide_t norm, linear, constant;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const double a = m[0][l], b = m[1][l], c = m[2][l], d = m[3][l], e = m[4][l], f = m[5][l];
        const double g = m[6][l], h = m[7][l], i = m[8][l];
        const double aa = e * i - f * h, ab = f * g - d * i, ac = d * h - e * g;
        const double ba = c * h - b * i, bb = a * i - c * g, bc = b * g - a * h;
        const double ca = b * f - c * e, cb = c * d - a * f, cc = a * e - b * d;
        const double n = a * a + b * b + c * c + d * d + e * e + f * f + g * g + h * h + i * i;
        const double cofactors = aa * aa + ab * ab + ac * ac + ba * ba + bb * bb + bc * bc + ca * ca + cb * cb + cc * cc;
        norm[l] = n;
        linear[l] = 8.0 * (a * aa + b * ab + c * ac);
        constant[l] = n * n - 4.0 * cofactors;
        x[l] = 1.7320508075688772;
    }
    for (int step = 0; step < EIGENVALUE_STEPS; ++step)
        for (size_t l = 0; l < PLIANT_LANES; ++l) {
            const double square = x[l] * x[l];
            const double value = (square - 2.0 * norm[l]) * square - linear[l] * x[l] + constant[l];
            const double slope = 4.0 * x[l] * (square - norm[l]) - linear[l];
            x[l] -= value / (slope > 1e-12 ? slope : 1.0);
        }
}

/* Takes the column where it is longer than the longest so far. */
static PLIANT_INLINE void take_longer(pliant_lanes column[4], pliant_lanes longest, pliant_lanes quaternion[4])
{
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float w = column[0][l], x = column[1][l], y = column[2][l], z = column[3][l];
        const float w0 = quaternion[0][l], x0 = quaternion[1][l], y0 = quaternion[2][l], z0 = quaternion[3][l];
        const float length = w * w + x * x + y * y + z * z, length0 = longest[l];
        quaternion[0][l] = length > length0 ? w : w0;
        quaternion[1][l] = length > length0 ? x : x0;
        quaternion[2][l] = length > length0 ? y : y0;
        quaternion[3][l] = length > length0 ? z : z0;
        longest[l] = length > length0 ? length : length0;
    }
}

/* The eigenvector: w, x, y, z, by the longest column of the adjugate of K - x. */
static PLIANT_INLINE void find_quaternion(pliant_lanes k[10], wide_t x, pliant_lanes quaternion[4])
{
    pliant_lanes columns[4][4], longest;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float r = (float)x[l];
        const float a = k[0][l] - r, b = k[1][l], c = k[2][l], d = k[3][l], e = k[4][l] - r;
        const float f = k[5][l], g = k[6][l], h = k[7][l] - r, i = k[8][l], j = k[9][l] - r;
        const float hj = h * j - i * i, fj = f * j - i * g, fi = f * i - h * g; /* minors of the lower two rows */
        const float cj = c * j - i * d, ci = c * i - h * d, cg = c * g - f * d;
        const float be = a * e - b * b, bf = a * f - c * b, bg = a * g - d * b; /* and of the upper two */
        const float cf = b * f - c * e, dg = b * g - d * e;
        columns[0][0][l] = e * hj - f * fj + g * fi;
        columns[0][1][l] = columns[1][0][l] = f * cj - b * hj - g * ci;
        columns[0][2][l] = columns[2][0][l] = b * fj - e * cj + g * cg;
        columns[0][3][l] = columns[3][0][l] = e * ci - b * fi - f * cg;
        columns[1][1][l] = a * hj - c * cj + d * ci;
        columns[1][2][l] = columns[2][1][l] = b * cj - a * fj - d * cg;
        columns[1][3][l] = columns[3][1][l] = a * fi - b * ci + c * cg;
        columns[2][2][l] = d * dg - g * bg + j * be;
        columns[2][3][l] = columns[3][2][l] = g * bf - d * cf - i * be;
        columns[3][3][l] = c * cf - f * bf + h * be;
        quaternion[0][l] = 1.0f;
        quaternion[1][l] = quaternion[2][l] = quaternion[3][l] = 0.0f;
        longest[l] = FLT_MIN;
    }
    for (int i = 0; i < 4; ++i) take_longer(columns[i], longest, quaternion);
}

/* To length 1, in double precision. */
static PLIANT_INLINE void widen_quaternion(pliant_lanes narrow[4], wide_t quaternion[4])
{
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const double w = (double)narrow[0][l], x = (double)narrow[1][l], y = (double)narrow[2][l], z = (double)narrow[3][l];
        const double scale = 1.0 / sqrt(w * w + x * x + y * y + z * z);
        quaternion[0][l] = w * scale;
        quaternion[1][l] = x * scale;
        quaternion[2][l] = y * scale;
        quaternion[3][l] = z * scale;
    }
}

/* Orthonormal to double precision whatever the rounding of the quaternion: tr(R^T M) then depends on that by its square. */
static PLIANT_INLINE void make_rotation(wide_t quaternion[4], wide_t rotation[9])
{
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const double w = quaternion[0][l], x = quaternion[1][l], y = quaternion[2][l], z = quaternion[3][l];
        const double n = 2.0 / (w * w + x * x + y * y + z * z);
        rotation[0][l] = 1.0 - n * (y * y + z * z);
        rotation[1][l] = n * (x * y - w * z);
        rotation[2][l] = n * (x * z + w * y);
        rotation[3][l] = n * (x * y + w * z);
        rotation[4][l] = 1.0 - n * (x * x + z * z);
        rotation[5][l] = n * (y * z - w * x);
        rotation[6][l] = n * (x * z - w * y);
        rotation[7][l] = n * (y * z + w * x);
        rotation[8][l] = 1.0 - n * (x * x + y * y);
    }
}

/* Entry of R^T M. */
static PLIANT_INLINE double product(wide_t rotation[9], wide_t m[9], size_t row, size_t column, size_t l)
{
    return rotation[row][l] * m[column][l] + rotation[3 + row][l] * m[3 + column][l]
        + rotation[6 + row][l] * m[6 + column][l];
}

/* Newton's method: with B = R^T M, t its torque and K = tr(B) - sym B, R turns by K^-1 t (Cayley's map). Where the
   maximum is no strict one, K is next to singular, and R stays as it is. */
static PLIANT_INLINE void improve_rotation(wide_t m[9], wide_t quaternion[4], wide_t rotation[9])
{
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const double b0 = product(rotation, m, 0, 0, l), b1 = product(rotation, m, 0, 1, l);
        const double b2 = product(rotation, m, 0, 2, l), b3 = product(rotation, m, 1, 0, l);
        const double b4 = product(rotation, m, 1, 1, l), b5 = product(rotation, m, 1, 2, l);
        const double b6 = product(rotation, m, 2, 0, l), b7 = product(rotation, m, 2, 1, l);
        const double b8 = product(rotation, m, 2, 2, l);
        const double tx = b7 - b5, ty = b2 - b6, tz = b3 - b1, xx = b4 + b8, yy = b0 + b8, zz = b0 + b4;
        const double xy = -0.5 * (b1 + b3), xz = -0.5 * (b2 + b6), yz = -0.5 * (b5 + b7);
        const double axx = yy * zz - yz * yz, axy = xz * yz - xy * zz, axz = xy * yz - xz * yy;
        const double ayy = xx * zz - xz * xz, ayz = xy * xz - xx * yz, azz = xx * yy - xy * xy;
        const double determinant = xx * axx + xy * axy + xz * axz;
        const double half = 0.5 / (determinant > 1e-9 ? determinant : 1e9);
        const double x = half * (axx * tx + axy * ty + axz * tz), y = half * (axy * tx + ayy * ty + ayz * tz);
        const double z = half * (axz * tx + ayz * ty + azz * tz);
        const double qw = quaternion[0][l], qx = quaternion[1][l], qy = quaternion[2][l], qz = quaternion[3][l];
        quaternion[0][l] = qw - qx * x - qy * y - qz * z;
        quaternion[1][l] = qx + qw * x + qy * z - qz * y;
        quaternion[2][l] = qy + qw * y + qz * x - qx * z;
        quaternion[3][l] = qz + qw * z + qx * y - qy * x;
    }
    make_rotation(quaternion, rotation);
}

static PLIANT_INLINE void find_rotation(wide_t moments[9], wide_t rotation[9])
{
    wide_t m[9], eigenvalue, quaternion[4];
    pliant_lanes horn[10], rough[4];
    scale_moments(moments, m);
    make_horn_matrix(m, horn);
    find_eigenvalue(m, eigenvalue);
    find_quaternion(horn, eigenvalue, rough);
    widen_quaternion(rough, quaternion);
    make_rotation(quaternion, rotation);
    for (int step = 0; step < ROTATION_STEPS; ++step) improve_rotation(m, quaternion, rotation);
}

/* A vector for each lane: x of all lanes, y, z. Loops run over all of it, since compilers unroll shorter ones to scalars. */
#define VECTOR_SIZE (3 * PLIANT_LANES)
typedef float vectors[VECTOR_SIZE];

typedef double wide_vectors[VECTOR_SIZE];

/* Of the spokes of a cell. */
typedef vectors spoke_vectors[PLIANT_FORMAT_MAX_VALENCE];

/* A spoke is the difference `head`, a rim that minus the difference `tail`. */
typedef struct cell_edge {
    uint32_t head, tail;
    int is_rim;
} cell_edge;

static PLIANT_INLINE cell_edge locate_edge(uint32_t edge, uint32_t valence)
{
    cell_edge ends = { edge, 0, 0 };
    if (edge >= valence) {
        ends.tail = edge - valence;
        ends.head = ends.tail + 1 == valence ? 0 : ends.tail + 1;
        ends.is_rim = 1;
    }
    return ends;
}

static PLIANT_INLINE void add_vectors(vectors to, const vectors from)
{
    for (size_t i = 0; i < VECTOR_SIZE; ++i) to[i] += from[i];
}

static PLIANT_INLINE void subtract_vectors(vectors to, const vectors from)
{
    for (size_t i = 0; i < VECTOR_SIZE; ++i) to[i] -= from[i];
}

static PLIANT_INLINE void copy_edge(spoke_vectors spokes, cell_edge ends, vectors edge)
{
    memcpy(edge, spokes[ends.head], sizeof(vectors));
    if (ends.is_rim) subtract_vectors(edge, spokes[ends.tail]);
}

static PLIANT_INLINE void add_to_ends(const vectors edge, cell_edge ends, spoke_vectors spokes)
{
    add_vectors(spokes[ends.head], edge);
    if (ends.is_rim) subtract_vectors(spokes[ends.tail], edge);
}

/* c = sum_k w_k c_k of an edge, for all three coordinates. */
static PLIANT_INLINE void combine_stiffness(const pliant_element_group* group, const pliant_arap_poses* poses, uint32_t edge,
                                            vectors stiffness)
{
    memset(stiffness, 0, sizeof(vectors));
    for (uint32_t k = 0; k < poses->pose_count; ++k) {
        const float weight = poses->weights[k];
        const float* c = group->numbers + k * poses->pose_stride + 4u * (size_t)edge * group->stride;
        for (size_t l = 0; l < PLIANT_LANES; ++l) stiffness[l] += weight * c[l];
    }
    memcpy(stiffness + PLIANT_LANES, stiffness, sizeof(pliant_lanes));
    memcpy(stiffness + 2 * PLIANT_LANES, stiffness, sizeof(pliant_lanes));
}

/* sum over edges of c (|edge|^2 - |edge0|^2), and its force: the part without a rotation, which does combine over poses.
   `start` and `grown`: the spokes at z = 0, and their change since. */
static PLIANT_INLINE void add_lengths(const pliant_element_group* group, const pliant_arap_poses* poses, spoke_vectors start,
                                      spoke_vectors grown, spoke_vectors force, wide_t energy)
{
    for (uint32_t i = 0; i < poses->edge_count; ++i) {
        const cell_edge ends = locate_edge(i, poses->valence);
        vectors stiffness, edge_start, edge_grown, edge_energy, edge_force;
        combine_stiffness(group, poses, i, stiffness);
        copy_edge(start, ends, edge_start);
        copy_edge(grown, ends, edge_grown);
        for (size_t j = 0; j < VECTOR_SIZE; ++j) {
            edge_energy[j] = stiffness[j] * ((2.0f * edge_start[j] + edge_grown[j]) * edge_grown[j]);
            edge_force[j] = 2.0f * stiffness[j] * (edge_start[j] + edge_grown[j]);
        }
        add_to_ends(edge_force, ends, force);
        for (size_t c = 0; c < VECTOR_SIZE; c += PLIANT_LANES)
            for (size_t l = 0; l < PLIANT_LANES; ++l) energy[l] += (double)edge_energy[c + l];
    }
}

/* q of every spoke: the sum of the p of its edges, those counted negative that leave it. Then M = sum of spoke q^T, and the
   force on the spoke is -2 w R q. */
static PLIANT_INLINE void sum_targets(const pliant_element_group* group, const pliant_arap_poses* poses,
                                      const float* numbers, wide_vectors* targets)
{
    memset(targets, 0, poses->valence * sizeof(wide_vectors));
    for (uint32_t i = 0; i < poses->edge_count; ++i) {
        const cell_edge ends = locate_edge(i, poses->valence);
        vectors p;
        for (size_t c = 0; c < 3; ++c)
            memcpy(p + c * PLIANT_LANES, numbers + (4u * (size_t)i + 1 + c) * group->stride, sizeof(pliant_lanes));
        for (size_t j = 0; j < VECTOR_SIZE; ++j) targets[ends.head][j] += (double)p[j];
        if (ends.is_rim)
            for (size_t j = 0; j < VECTOR_SIZE; ++j) targets[ends.tail][j] -= (double)p[j];
    }
}

/* moments = sum over spokes of spoke q^T, row-major. */
static PLIANT_INLINE void sum_moments(uint32_t valence, spoke_vectors start, spoke_vectors grown, wide_vectors* targets,
                                      wide_t moments[9])
{
    memset(moments, 0, 9 * sizeof(wide_t));
    for (uint32_t i = 0; i < valence; ++i) {
        const float *s = start[i], *g = grown[i];
        const double* q = targets[i];
        for (size_t l = 0; l < PLIANT_LANES; ++l) {
            const size_t m = l + PLIANT_LANES, n = l + 2 * PLIANT_LANES;
            const double x = (double)s[l] + (double)g[l], y = (double)s[m] + (double)g[m], z = (double)s[n] + (double)g[n];
            const double u = q[l], v = q[m], w = q[n];
            moments[0][l] += x * u;
            moments[1][l] += x * v;
            moments[2][l] += x * w;
            moments[3][l] += y * u;
            moments[4][l] += y * v;
            moments[5][l] += y * w;
            moments[6][l] += z * u;
            moments[7][l] += z * v;
            moments[8][l] += z * w;
        }
    }
}

/* force += factor R q for every spoke. */
static PLIANT_INLINE void add_rotated(uint32_t valence, float factor, wide_t rotation[9], wide_vectors* targets,
                                      spoke_vectors force)
{
    pliant_lanes turn[9];
    for (int i = 0; i < 9; ++i)
        for (size_t l = 0; l < PLIANT_LANES; ++l) turn[i][l] = factor * (float)rotation[i][l];
    for (uint32_t i = 0; i < valence; ++i) {
        const double* q = targets[i];
        vectors turned;
        for (size_t l = 0; l < PLIANT_LANES; ++l) {
            const float x = (float)q[l], y = (float)q[l + PLIANT_LANES], z = (float)q[l + 2 * PLIANT_LANES];
            turned[l] = turn[0][l] * x + turn[1][l] * y + turn[2][l] * z;
            turned[l + PLIANT_LANES] = turn[3][l] * x + turn[4][l] * y + turn[5][l] * z;
            turned[l + 2 * PLIANT_LANES] = turn[6][l] * x + turn[7][l] * y + turn[8][l] * z;
        }
        add_vectors(force[i], turned);
    }
}

/* The best rotation, and sigma(M) = tr(R^T M). */
static PLIANT_INLINE void measure_sigma(wide_t moments[9], wide_t rotation[9], wide_t sigma)
{
    find_rotation(moments, rotation);
    memset(sigma, 0, sizeof(wide_t));
    for (int i = 0; i < 9; ++i)
        for (size_t l = 0; l < PLIANT_LANES; ++l) sigma[l] += rotation[i][l] * moments[i][l];
}

/* Adds -2 w (sigma(M) - sigma0) and its force for one pose. */
static PLIANT_INLINE void add_rotated_pose(const pliant_element_group* group, const pliant_arap_poses* poses, uint32_t pose,
                                           spoke_vectors start, spoke_vectors grown, spoke_vectors force, wide_t energy)
{
    const float* numbers = group->numbers + pose * poses->pose_stride;
    const float* sigma0 = numbers + 4u * (size_t)poses->edge_count * group->stride;
    const float factor = -2.0f * poses->weights[pose];
    wide_vectors targets[PLIANT_FORMAT_MAX_VALENCE];
    wide_t moments[9], rotation[9], sigma;
    sum_targets(group, poses, numbers, targets);
    sum_moments(poses->valence, start, grown, targets, moments);
    measure_sigma(moments, rotation, sigma);
    for (size_t l = 0; l < PLIANT_LANES; ++l) energy[l] += (double)factor * (sigma[l] - (double)sigma0[l]);
    for (size_t l = 0; poses->is_finished && l < PLIANT_LANES; ++l)
        energy[l] -= (double)factor * (double)sigma0[group->stride + l];
    add_rotated(poses->valence, factor, rotation, targets, force);
}

static PLIANT_INLINE void read_spokes(uint32_t valence, const float* rows, size_t stride, spoke_vectors spokes)
{
    for (uint32_t i = 0; i < valence; ++i)
        for (size_t c = 0; c < 3; ++c)
            memcpy(spokes[i] + c * PLIANT_LANES, rows + (3u * i + c) * stride, sizeof(pliant_lanes));
}

static PLIANT_INLINE void evaluate_arap_cell(const pliant_element_group* group, const pliant_arap_poses* poses,
                                             float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy)
{
    wide_t sum = { 0 };
    spoke_vectors start, grown, total;
    memset(total, 0, poses->valence * sizeof(vectors));
    read_spokes(poses->valence, group->rows, group->stride, start);
    read_spokes(poses->valence, group->change, group->block_stride, grown);
    add_lengths(group, poses, start, grown, total, sum);
    for (uint32_t k = 0; k < poses->pose_count; ++k)
        if (poses->weights[k] > 0.0f) add_rotated_pose(group, poses, k, start, grown, total, sum);
    for (uint32_t i = 0; i < poses->valence; ++i)
        for (size_t c = 0; c < 3; ++c)
            memcpy(force + (3u * i + c) * group->block_stride, total[i] + c * PLIANT_LANES, sizeof(pliant_lanes));
    for (size_t l = 0; l < PLIANT_LANES; ++l) energy[l] += (float)sum[l];
}

/* A cell of layers: c of the edges to where the plain kind has it, and sigma0 by the steps of the evaluation and with the
   digits that a float lacks, so that the energy at z = 0 is 0: sigma is some thousand times the energies that count. */
static PLIANT_INLINE void finish_arap_cell(const pliant_element_group* group, const pliant_arap_poses* poses,
                                           float* PLIANT_RESTRICT plain)
{
    wide_vectors targets[PLIANT_FORMAT_MAX_VALENCE];
    wide_t moments[9], rotation[9], sigma;
    spoke_vectors start, grown;
    float* sigma0 = plain + 4u * (size_t)poses->edge_count * group->stride;
    for (size_t i = 0; i < poses->edge_count; ++i)
        memcpy(plain + 4u * i * group->stride, group->fixed + i * group->stride, sizeof(pliant_lanes));
    read_spokes(poses->valence, group->rows, group->stride, start);
    memset(grown, 0, poses->valence * sizeof(vectors));
    sum_targets(group, poses, plain, targets);
    sum_moments(poses->valence, start, grown, targets, moments);
    measure_sigma(moments, rotation, sigma);
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        sigma0[l] = (float)sigma[l];
        sigma0[group->stride + l] = (float)(sigma[l] - (double)sigma0[l]);
    }
}

PLIANT_WIDE_KERNEL(finish_arap_cell,
                   (const pliant_element_group* group, const pliant_arap_poses* poses, float* PLIANT_RESTRICT plain),
                   (group, poses, plain))
PLIANT_WIDE_KERNEL(evaluate_arap_cell,
                   (const pliant_element_group* group, const pliant_arap_poses* poses, float* PLIANT_RESTRICT force,
                    float* PLIANT_RESTRICT energy),
                   (group, poses, force, energy))
