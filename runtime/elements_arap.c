/* The ARAP cell (spokes and rims), 16 at a time. Formula: formats/SPEC.md, kind 5.

   The largest tr(R^T M) over rotations R is the largest eigenvalue of Horn's symmetric 4x4 matrix of M, its eigenvector
   the quaternion of R: the sign of det M, repeated and vanishing singular values need no cases, and the error is that of
   the problem itself (Horn, "Closed-form solution of absolute orientation using unit quaternions", JOSA A 1987). The
   eigenvector comes from a fixed number of cyclic Jacobi sweeps, branch-free over the lanes.

   Energy: Sorkine, Alexa, "As-Rigid-As-Possible Surface Modeling", SGP 2007; spokes and rims: Chao, Pinkall, Sanan,
   Schroeder, "A Simple Geometric Model for Elastic Deformations", SIGGRAPH 2010. */
#include "internal.h"
#include "lane_math.h"

/* Jacobi converges quadratically: three sweeps leave 1e-4 at worst, the fourth single precision, one for safety. */
#define SWEEP_COUNT 5

/* Added to squares of numbers of size 1: nothing beside them, and keeps 0/0 away where a rotation has nothing to do. */
#define TINY 1e-30f

/* Energies of a cell are differences of numbers of the size of c |edge|^2, a hundred to ten thousand times larger. What
   enters them (moments, rotations, sums) is therefore formed in double precision; forces do not cancel and stay single. */
typedef double wide_t[PLIANT_LANES];

/* Turns the plane (p, q) so that k[p][q] vanishes, and the rows of `vectors` alike; r and t are the other two indices. k
   holds the whole symmetric matrix. Inlined with constants, or compilers could not tell the rows apart. */
static PLIANT_INLINE void rotate_plane(pliant_lanes k[4][4], pliant_lanes vectors[4][4], int p, int q, int r, int t)
{
    pliant_lanes cosine, sine;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float off = 2.0f * k[p][q][l];
        const float gap = k[q][q][l] - k[p][p][l];
        const float root = sqrtf(gap * gap + off * off + TINY);
        const float tangent = (gap < 0.0f ? -off : off) / (fabsf(gap) + root);
        const float moved = 0.5f * tangent * off;
        cosine[l] = 1.0f / sqrtf(1.0f + tangent * tangent);
        sine[l] = tangent * cosine[l];
        k[p][p][l] -= moved;
        k[q][q][l] += moved;
        k[p][q][l] = k[q][p][l] = 0.0f;
    }
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float pr = k[p][r][l], qr = k[q][r][l], pt = k[p][t][l], qt = k[q][t][l];
        k[p][r][l] = k[r][p][l] = cosine[l] * pr - sine[l] * qr;
        k[q][r][l] = k[r][q][l] = sine[l] * pr + cosine[l] * qr;
        k[p][t][l] = k[t][p][l] = cosine[l] * pt - sine[l] * qt;
        k[q][t][l] = k[t][q][l] = sine[l] * pt + cosine[l] * qt;
    }
    for (int i = 0; i < 4; ++i)
        for (size_t l = 0; l < PLIANT_LANES; ++l) {
            const float vp = vectors[p][i][l], vq = vectors[q][i][l];
            vectors[p][i][l] = cosine[l] * vp - sine[l] * vq;
            vectors[q][i][l] = sine[l] * vp + cosine[l] * vq;
        }
}

/* Horn's matrix of moments = sum edge p^T (row-major), scaled so that its entries are of size 1. The rotation takes p to the
   edge. */
static PLIANT_INLINE void make_horn_matrix(wide_t moments[9], pliant_lanes k[4][4])
{
    pliant_lanes scale = { 0 }, m[9];
    for (int i = 0; i < 9; ++i)
        for (size_t l = 0; l < PLIANT_LANES; ++l) m[i][l] = (float)moments[i][l];
    for (int i = 0; i < 9; ++i)
        for (size_t l = 0; l < PLIANT_LANES; ++l) scale[l] = fabsf(m[i][l]) > scale[l] ? fabsf(m[i][l]) : scale[l];
    for (size_t l = 0; l < PLIANT_LANES; ++l) scale[l] = scale[l] > FLT_MIN ? 1.0f / scale[l] : 0.0f;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float xx = m[0][l] * scale[l], xy = m[1][l] * scale[l], xz = m[2][l] * scale[l];
        const float yx = m[3][l] * scale[l], yy = m[4][l] * scale[l], yz = m[5][l] * scale[l];
        const float zx = m[6][l] * scale[l], zy = m[7][l] * scale[l], zz = m[8][l] * scale[l];
        k[0][0][l] = xx + yy + zz;
        k[1][1][l] = xx - yy - zz;
        k[2][2][l] = yy - xx - zz;
        k[3][3][l] = zz - xx - yy;
        k[0][1][l] = k[1][0][l] = zy - yz;
        k[0][2][l] = k[2][0][l] = xz - zx;
        k[0][3][l] = k[3][0][l] = yx - xy;
        k[1][2][l] = k[2][1][l] = xy + yx;
        k[1][3][l] = k[3][1][l] = xz + zx;
        k[2][3][l] = k[3][2][l] = yz + zy;
    }
}

/* The eigenvector of the largest eigenvalue: w, x, y, z. */
static PLIANT_INLINE void pick_quaternion(pliant_lanes k[4][4], pliant_lanes vectors[4][4], pliant_lanes quaternion[4])
{
    pliant_lanes best;
    memcpy(best, k[0][0], sizeof best);
    memcpy(quaternion, vectors[0], 4 * sizeof(pliant_lanes));
    for (int i = 1; i < 4; ++i) {
        for (int j = 0; j < 4; ++j)
            for (size_t l = 0; l < PLIANT_LANES; ++l)
                quaternion[j][l] = k[i][i][l] > best[l] ? vectors[i][j][l] : quaternion[j][l];
        for (size_t l = 0; l < PLIANT_LANES; ++l) best[l] = k[i][i][l] > best[l] ? k[i][i][l] : best[l];
    }
}

/* Orthonormal to double precision whatever the rounding of the quaternion: tr(R^T M) then depends on that by its square. */
static PLIANT_INLINE void make_rotation(pliant_lanes quaternion[4], wide_t rotation[9])
{
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const double w = (double)quaternion[0][l], x = (double)quaternion[1][l];
        const double y = (double)quaternion[2][l], z = (double)quaternion[3][l];
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

static PLIANT_INLINE void find_rotation(wide_t moments[9], wide_t rotation[9])
{
    pliant_lanes k[4][4], vectors[4][4], quaternion[4];
    make_horn_matrix(moments, k);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (size_t l = 0; l < PLIANT_LANES; ++l) vectors[i][j][l] = i == j ? 1.0f : 0.0f;
    for (int sweep = 0; sweep < SWEEP_COUNT; ++sweep) {
        rotate_plane(k, vectors, 0, 1, 2, 3);
        rotate_plane(k, vectors, 2, 3, 0, 1);
        rotate_plane(k, vectors, 0, 2, 1, 3);
        rotate_plane(k, vectors, 1, 3, 0, 2);
        rotate_plane(k, vectors, 0, 3, 1, 2);
        rotate_plane(k, vectors, 1, 2, 0, 3);
    }
    pick_quaternion(k, vectors, quaternion);
    make_rotation(quaternion, rotation);
}

/* Rows of the differences that make an edge: a spoke is one of them, a rim the next minus this. */
typedef struct edge_rows {
    size_t head; /* first row of the difference that counts positive */
    size_t tail; /* of the one that counts negative; meaningless for a spoke */
    int is_rim;
} edge_rows;

static PLIANT_INLINE edge_rows locate_edge(uint32_t edge, uint32_t valence)
{
    edge_rows rows = { 3u * (size_t)edge, 0, 0 };
    if (edge >= valence) {
        const uint32_t spoke = edge - valence;
        rows.head = 3u * (size_t)(spoke + 1 == valence ? 0 : spoke + 1);
        rows.tail = 3u * (size_t)spoke;
        rows.is_rim = 1;
    }
    return rows;
}

/* Coordinate c of an edge at z = 0, and its change since. */
static PLIANT_INLINE void read_edge(const pliant_element_group* group, edge_rows rows, size_t c, pliant_lanes start,
                                    pliant_lanes grown)
{
    memcpy(start, group->rows + (rows.head + c) * group->stride, sizeof(pliant_lanes));
    memcpy(grown, group->change + (rows.head + c) * group->block_stride, sizeof(pliant_lanes));
    if (!rows.is_rim) return;
    const float* tail_start = group->rows + (rows.tail + c) * group->stride;
    const float* tail_change = group->change + (rows.tail + c) * group->block_stride;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        start[l] -= tail_start[l];
        grown[l] -= tail_change[l];
    }
}

static PLIANT_INLINE void add_edge_force(const pliant_element_group* group, edge_rows rows, size_t c,
                                         const pliant_lanes edge_force, float* PLIANT_RESTRICT force)
{
    float* head = force + (rows.head + c) * group->block_stride;
    for (size_t l = 0; l < PLIANT_LANES; ++l) head[l] += edge_force[l];
    if (!rows.is_rim) return;
    float* tail = force + (rows.tail + c) * group->block_stride;
    for (size_t l = 0; l < PLIANT_LANES; ++l) tail[l] -= edge_force[l];
}

/* sum over edges of c (|edge|^2 - |edge0|^2) with c = sum_k w_k c_k, and its force: the part without a rotation, which does
   combine over poses. */
static PLIANT_INLINE void add_lengths(const pliant_element_group* group, const pliant_arap_poses* poses,
                                      float* PLIANT_RESTRICT force, wide_t energy)
{
    for (uint32_t i = 0; i < poses->edge_count; ++i) {
        const edge_rows rows = locate_edge(i, poses->valence);
        pliant_lanes stiffness = { 0 };
        for (uint32_t k = 0; k < poses->pose_count; ++k) {
            const float weight = poses->weights[k];
            const float* c = group->numbers + k * poses->pose_stride + 4u * (size_t)i * group->stride;
            for (size_t l = 0; l < PLIANT_LANES; ++l) stiffness[l] += weight * c[l];
        }
        for (size_t c = 0; c < 3; ++c) {
            pliant_lanes start, grown, edge_force;
            read_edge(group, rows, c, start, grown);
            for (size_t l = 0; l < PLIANT_LANES; ++l) {
                energy[l] += (double)(stiffness[l] * ((2.0f * start[l] + grown[l]) * grown[l]));
                edge_force[l] = 2.0f * stiffness[l] * (start[l] + grown[l]);
            }
            add_edge_force(group, rows, c, edge_force, force);
        }
    }
}

/* moments = sum over edges of edge p^T for one pose, row-major. */
static PLIANT_INLINE void sum_moments(const pliant_element_group* group, const pliant_arap_poses* poses,
                                      const float* numbers, wide_t moments[9])
{
    memset(moments, 0, 9 * sizeof(wide_t));
    for (uint32_t i = 0; i < poses->edge_count; ++i) {
        const edge_rows rows = locate_edge(i, poses->valence);
        const float* p = numbers + (4u * (size_t)i + 1) * group->stride;
        for (size_t c = 0; c < 3; ++c) {
            pliant_lanes start, grown;
            read_edge(group, rows, c, start, grown);
            for (size_t column = 0; column < 3; ++column)
                for (size_t l = 0; l < PLIANT_LANES; ++l)
                    moments[3 * c + column][l]
                        += ((double)start[l] + (double)grown[l]) * (double)p[column * group->stride + l];
        }
    }
}

/* Adds -2 w (sigma(M) - sigma0) and its force -2 w R p for one pose. */
static PLIANT_INLINE void add_rotated_pose(const pliant_element_group* group, const pliant_arap_poses* poses, uint32_t pose,
                                           float* PLIANT_RESTRICT force, wide_t energy)
{
    const float* numbers = group->numbers + pose * poses->pose_stride;
    const float* sigma0 = numbers + 4u * (size_t)poses->edge_count * group->stride;
    const float factor = -2.0f * poses->weights[pose];
    wide_t moments[9], rotation[9];
    pliant_lanes turn[9];
    sum_moments(group, poses, numbers, moments);
    find_rotation(moments, rotation);
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        double sigma = 0.0;
        for (int i = 0; i < 9; ++i) sigma += rotation[i][l] * moments[i][l];
        energy[l] += (double)factor * (sigma - (double)sigma0[l]);
    }
    for (int i = 0; i < 9; ++i)
        for (size_t l = 0; l < PLIANT_LANES; ++l) turn[i][l] = (float)rotation[i][l];
    for (uint32_t i = 0; i < poses->edge_count; ++i) {
        const edge_rows rows = locate_edge(i, poses->valence);
        const float* p = numbers + (4u * (size_t)i + 1) * group->stride;
        for (size_t c = 0; c < 3; ++c) {
            pliant_lanes edge_force;
            for (size_t l = 0; l < PLIANT_LANES; ++l)
                edge_force[l] = factor
                    * (turn[3 * c][l] * p[l] + turn[3 * c + 1][l] * p[group->stride + l]
                       + turn[3 * c + 2][l] * p[2 * group->stride + l]);
            add_edge_force(group, rows, c, edge_force, force);
        }
    }
}

static PLIANT_INLINE void evaluate_arap_cell(const pliant_element_group* group, const pliant_arap_poses* poses,
                                             float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy)
{
    wide_t sum = { 0 };
    for (size_t r = 0; r < 3u * (size_t)poses->valence; ++r)
        memset(force + r * group->block_stride, 0, sizeof(pliant_lanes));
    add_lengths(group, poses, force, sum);
    for (uint32_t k = 0; k < poses->pose_count; ++k)
        if (poses->weights[k] > 0.0f) add_rotated_pose(group, poses, k, force, sum);
    for (size_t l = 0; l < PLIANT_LANES; ++l) energy[l] += (float)sum[l];
}

PLIANT_KERNEL(evaluate_arap_cell,
              (const pliant_element_group* group, const pliant_arap_poses* poses, float* PLIANT_RESTRICT force,
               float* PLIANT_RESTRICT energy),
              (group, poses, force, energy))
