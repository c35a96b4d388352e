/* What the files of the runtime share. Not installed, not part of the API. */
#ifndef PLIANT_INTERNAL_H
#define PLIANT_INTERNAL_H

#include "pliant.h"

#include "pliant_format.h"

#include <string.h>

/* Functions round by adding and subtracting a large number, which fast-math leaves out and the x87 does with 64 bits: shapes
   would be wrong. With contraction off clang defines the second macro alone. -fassociative-math alone does the same harm:
   gcc has a macro for it, clang a pragma against it. The last macro is 16 where a processor has half precision, too. */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(_M_FP_FAST) \
    || defined(__ASSOCIATIVE_MATH__)
#error "Pliant cannot be compiled with fast-math: add -fno-fast-math, of MSVC /fp:precise"
#endif
#if defined(__clang_major__) && __clang_major__ >= 13
#pragma clang fp reassociate(off) contract(off)
#endif
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ < 0 || __FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2)
#error "Pliant cannot be compiled for the x87: on 32-bit x86 add -msse2 -mfpmath=sse"
#endif

/* Vector loops run over this many floats, a constant, so that every build adds in the same order whatever its vectors'
   width: 16 lanes are four SSE registers, two of AVX, one of AVX-512. */
#define PLIANT_LANES PLIANT_FORMAT_LANES

#if defined(__GNUC__) || defined(_MSC_VER)
#define PLIANT_RESTRICT __restrict /* in C++, too */
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 199901L
#define PLIANT_RESTRICT restrict
#else
#define PLIANT_RESTRICT
#endif

/* Vector code that counts is compiled twice where that can be: for the compiler's default and for AVX2; what unpacks a basis
   a third time, for AVX-512, where it gains a quarter, and ARAP cells, which compute much in double precision (a fifth). The
   other passes wait for memory. The processor is asked when an asset is opened. All do the same
   operations in the same order, hence the same bits; FMA, which rounds once where they round twice, stays off. No copies
   where all is compiled for AVX2 anyway, for MSVC, which has no attribute for them, or with PLIANT_NO_DISPATCH. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(_MSC_VER) && !defined(__AVX2__) && !defined(PLIANT_NO_DISPATCH)
#define PLIANT_HAS_AVX2_COPY 1
#define PLIANT_TARGET_avx2 __attribute__((target("avx2")))
#define PLIANT_TARGET_avx512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))
/* Makes the kernel pliant_NAME out of the function NAME, and pliant_NAME_avx2 out of the same. */
#define PLIANT_KERNEL(name, parameters, arguments)    \
    void pliant_##name parameters { name arguments; } \
    PLIANT_TARGET_avx2 void pliant_##name##_avx2 parameters { name arguments; }
/* The same, and pliant_NAME_avx512. */
#define PLIANT_WIDE_KERNEL(name, parameters, arguments) \
    PLIANT_KERNEL(name, parameters, arguments)          \
    PLIANT_TARGET_avx512 void pliant_##name##_avx512 parameters { name arguments; }
#else
#define PLIANT_HAS_AVX2_COPY 0
#define PLIANT_KERNEL(name, parameters, arguments) \
    void pliant_##name parameters { name arguments; }
#define PLIANT_WIDE_KERNEL(name, parameters, arguments) PLIANT_KERNEL(name, parameters, arguments)
#endif

/* What a kernel calls becomes part of it, or it would remain code for the compiler's default. */
#if defined(__GNUC__)
#define PLIANT_INLINE inline __attribute__((always_inline))
#else
#define PLIANT_INLINE inline
#endif

static inline size_t pliant_pad_lanes(size_t count) { return (count + (PLIANT_LANES - 1)) & ~(size_t)(PLIANT_LANES - 1); }

/* True unless `value` is an infinity or not a number. By its bits, which no option of a compiler takes away. */
static inline int pliant_is_finite(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (bits & 0x7F800000u) != 0x7F800000u;
}

/* Whether an asset has what positions are rebuilt from, in one of the three forms. */
static inline int pliant_has_shape(const pliant_asset* asset) { return asset->rest || asset->products; }

/* ------------------------------------------------------------------------------------------------------ kernels ---- */

/* Rows of a block: some lanes of a batch, one column for each reduced coordinate. */
typedef struct pliant_block {
    const float* columns; /* the first one's first row */
    size_t column_floats; /* from one column to the next */
    size_t column_count;
    size_t row_count;
    size_t stride; /* from one row of a column to the next */
    size_t lanes;  /* how many of a row belong to the block; rows of differences and forces lie this far apart */
} pliant_block;

/* A row of one group. */
typedef float pliant_lanes[PLIANT_LANES];

/* Forces of a group, worked out row by row on the stack, to where they belong. */
static PLIANT_INLINE void pliant_store_rows(float* PLIANT_RESTRICT force, size_t block_stride,
                                            pliant_lanes* PLIANT_RESTRICT rows, size_t row_count)
{
    for (size_t r = 0; r < row_count; ++r) memcpy(force + r * block_stride, rows[r], sizeof(pliant_lanes));
}

/* One group of PLIANT_LANES elements. Row r of an array lies at `r * its stride`. */
typedef struct pliant_element_group {
    const float* rows; /* differences at z = 0; tetrahedra know theirs */
    const float* fixed;
    const float* numbers; /* combined pose numbers; for ARAP those of pose 0 as stored */
    size_t stride;        /* of rows, fixed and numbers: the padded element count of the batch */
    const float* change;  /* differences minus those at z = 0 */
    size_t block_stride;  /* of change, and of the forces written: derivatives by the differences */
} pliant_element_group;

/* What an ARAP cell needs beside its group. The numbers of pose k lie pose_stride floats behind those of pose k-1. Of layers
   there is one pose, of weight 1. */
typedef struct pliant_arap_poses {
    uint32_t valence;
    uint32_t edge_count;
    const float* weights;
    uint32_t pose_count;
    size_t pose_stride;
    int is_finished; /* of layers: behind sigma0 lies what its rounding to a float has left over */
} pliant_arap_poses;

/* y = sum over j < columns of x[j] * matrix[j], each matrix[j] being `count` floats: a product with the columns' matrix. */
typedef void pliant_combine_kernel(float* PLIANT_RESTRICT y, const float* PLIANT_RESTRICT matrix,
                                   const float* PLIANT_RESTRICT x, size_t columns, size_t count);

/* matrix += u v^T + v u^T, of `count` squared. */
typedef void pliant_symmetric_kernel(float* PLIANT_RESTRICT matrix, const float* PLIANT_RESTRICT u,
                                     const float* PLIANT_RESTRICT v, size_t count);

/* change = sum over columns of z[j] * column j */
typedef void pliant_forward_kernel(const pliant_block* block, const float* z, float* change);

/* gradient[j] += <force, column j> */
typedef void pliant_backward_kernel(const pliant_block* block, const float* force, float* gradient);

/* Writes the forces of a group of elements and adds their energy to energy[PLIANT_LANES]. */
typedef void pliant_element_kernel(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                   float* PLIANT_RESTRICT energy);
typedef void pliant_arap_kernel(const pliant_element_group* group, const pliant_arap_poses* poses,
                                float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy);

/* Of layers, once a frame: `plain` is one group of the fixed numbers and then the numbers of the plain kind, rows at
   group->stride, and the combined numbers of the layered kind are already in it (elements_layers.c). This computes the rest
   from them, from the layered kind's fixed numbers and, for ARAP, from the rows. */
typedef void pliant_finish_kernel(const pliant_element_group* group, const pliant_arap_poses* poses,
                                  float* PLIANT_RESTRICT plain);

/* Value and gradient of the quartic with the coefficients `table`, z having `dimension` numbers. */
typedef void pliant_quartic_kernel(uint32_t dimension, const float* table, const float* z, float* PLIANT_RESTRICT gradient,
                                   float* scratch, double* energy);

/* What a reconstruction knows of its q. */
typedef struct pliant_frame {
    const float* q;
    uint32_t columns;                          /* how many count */
    float origin[PLIANT_FORMAT_TILE_FLOATS];   /* of the asset, for every vertex of a tile */
    float scaled[PLIANT_FORMAT_MAX_DIMENSION]; /* of BASC and BASF: q by the columns' scales */
    /* of BASC: and by those of their bases: three times each, then 0 for a field's width */
    float bases[4 * PLIANT_FORMAT_MAX_DIMENSION];
} pliant_frame;

void pliant_frame_begin(const pliant_asset* asset, const float* q, uint32_t columns, pliant_frame* frame);

/* The vertices of tile `tile` of BASI, x y z each, or of BASF: 16 times x, then y, then z, in each of its parts. */
typedef void pliant_tile_kernel(const pliant_asset* asset, const pliant_frame* frame, size_t tile,
                                float* PLIANT_RESTRICT out);

/* Those of parts first .. end-1 of tile `tile` of BASC. */
typedef void pliant_compact_kernel(const pliant_asset* asset, const pliant_frame* frame, size_t tile, size_t first,
                                   size_t end, float* PLIANT_RESTRICT out);

/* In pliant_normals.neighbours, on the first index of a run; indices are below 2^26. */
#define PLIANT_RUN_START 0x80000000u

/* The normals of `count` vertices (at most PLIANT_LANES) from `first` on: x y z each, PLIANT_LANES of them are written. */
typedef void pliant_normals_kernel(const pliant_normals* normals, const unsigned char* positions, size_t stride,
                                   size_t first, size_t count, float* PLIANT_RESTRICT out);

/* Every kernel, X(TYPE, NAME, WIDEST): pliant_NAME is of type pliant_TYPE_kernel, and WIDEST is the widest instruction set
   that has a copy of it, where there are copies. */
/* clang-format off */
#define PLIANT_KERNELS(X)                        \
    X(combine, combine_columns, avx2)            \
    X(symmetric, add_symmetric, avx2)            \
    X(forward, pass_forward, avx2)               \
    X(backward, pass_backward, avx2)             \
    X(element, evaluate_hinge, avx2)             \
    X(element, evaluate_face_neo_hookean, avx2)  \
    X(element, evaluate_face_stvk, avx2)         \
    X(element, evaluate_face_edge, avx2)         \
    X(arap, evaluate_arap_cell, avx512)          \
    X(element, evaluate_tet_stvk, avx2)          \
    X(element, evaluate_tet_mooney_rivlin, avx2) \
    X(element, evaluate_tie, avx2)               \
    X(finish, finish_hinge, avx2)                \
    X(finish, finish_face_neo_hookean, avx2)     \
    X(finish, finish_arap_cell, avx512)          \
    X(quartic, evaluate_quartic, avx2)           \
    X(tile, rebuild_tile, avx2)                  \
    X(compact, rebuild_compact, avx512)          \
    X(tile, rebuild_factored, avx512)            \
    X(normals, normals_of_block, avx2)
/* clang-format on */

/* One instruction set's. */
#define PLIANT_KERNEL_MEMBER(type, name, widest) pliant_##type##_kernel* name;
typedef struct pliant_kernels {
    PLIANT_KERNELS(PLIANT_KERNEL_MEMBER)
} pliant_kernels;
#undef PLIANT_KERNEL_MEMBER

/* Those for the compiler's default. */
extern const pliant_kernels pliant_kernels_plain;
#if PLIANT_HAS_AVX2_COPY
extern const pliant_kernels pliant_kernels_avx2, pliant_kernels_avx512;
#endif
/* The best for this processor. An answer from it may take a microsecond, in a virtual machine more. */
const pliant_kernels* pliant_kernels_choose(void);

/* The functions; a copy for AVX2 is declared twice where that is the widest. */
#if PLIANT_HAS_AVX2_COPY
#define PLIANT_KERNEL_DECLARE(type, name, widest)                   \
    pliant_##type##_kernel pliant_##name;                           \
    PLIANT_TARGET_avx2 pliant_##type##_kernel pliant_##name##_avx2; \
    PLIANT_TARGET_##widest pliant_##type##_kernel pliant_##name##_##widest;
#else
#define PLIANT_KERNEL_DECLARE(type, name, widest) pliant_##type##_kernel pliant_##name;
#endif
PLIANT_KERNELS(PLIANT_KERNEL_DECLARE)
#undef PLIANT_KERNEL_DECLARE

/* --------------------------------------------------------------------------------------------- surrogate energy ---- */

/* An asset has elements or a quartic polynomial: objective.c decides which three functions to call. */

/* Memory that an evaluation needs, in floats; every array starts at a multiple of 64 bytes. */
typedef struct pliant_energy_layout {
    /* All numbers that there are per pose, combined for the weights of the frame; of layers fixed numbers, too. */
    uint64_t combined_floats;
    uint64_t scratch_floats; /* elements: one block of differences, and as much for the derivatives by them */
} pliant_energy_layout;

pliant_energy_layout pliant_elements_measure(const pliant_asset* asset);

/* Combines the per-pose numbers of all batches (those of ARAP excepted, which are not linear) for normalised weights, or for
   (1, v) those of layers, ARAP included. */
void pliant_elements_combine(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights,
                             float* combined);

/* Value and gradient of the surrogate energy at z. Arrays of z and gradient have padded_dimension floats; the padding of the
   gradient comes back as zero. The value may come back as infinity or not-a-number: the caller decides. */
double pliant_elements_evaluate(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights,
                                const float* combined, const float* z, float* gradient, float* scratch);

/* What the numbers of a batch of layers become: those of a batch of this kind, which is then evaluated. */
static inline uint32_t pliant_plain_kind(uint32_t kind)
{
    switch (kind) {
    case PLIANT_ELEMENT_LAYERED_HINGE: return PLIANT_ELEMENT_HINGE;
    case PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN: return PLIANT_ELEMENT_FACE_NEO_HOOKEAN;
    case PLIANT_ELEMENT_LAYERED_ARAP_CELL: return PLIANT_ELEMENT_ARAP_CELL;
    default: return kind;
    }
}

/* Fixed numbers, then numbers of the plain kind, for the weights (1, v); for one batch of an asset of layers. */
void pliant_layers_combine(const pliant_kernels* kernels, const pliant_asset* asset, const pliant_format_batch* batch,
                           const float* weights, float* plain);

/* The same for QUAR. */
pliant_energy_layout pliant_quartic_measure(const pliant_asset* asset);
void pliant_quartic_combine(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights, float* combined);
double pliant_quartic_evaluate(const pliant_kernels* kernels, const pliant_asset* asset, const float* combined,
                               const float* z, float* gradient, float* scratch);

/* ----------------------------------------------------------------------------------------- functions of the weights ---- */

/* Floats that pliant_radial_evaluate needs as scratch. */
uint64_t pliant_radial_floats(const pliant_asset* asset);

/* The start z0(w) and the dead load c(w) for normalised weights or (1, v), padded_dimension floats each, padding zero; 0
   where the asset has none. `load` must be null if the asset has none. Cost: centre_count * (pose_count, of layers
   twice, + dimension for each) multiply-adds. */
void pliant_radial_evaluate(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights, float* scratch,
                            float* start, float* load);

/* ------------------------------------------------------------------------------------------------------- solver ---- */

/* Below this part of the energy scale differences of energies are rounding: a sum of some hundred single-precision terms
   of the size of the scale is known to about 1e-5 of it. */
#define PLIANT_ENERGY_NOISE 2e-5

struct pliant_solver {
    uint32_t magic; /* says that this memory was initialised */
    pliant_solver_desc desc;
    pliant_asset asset;
    const pliant_kernels* kernels;

    int has_history;         /* whether the last frame is known */
    int is_settled;          /* whether z, energy and gradient are those of the last frame, and it converged */
    float* weights;          /* of this frame, normalised, or (1, v) of layers; padded pose count */
    float* previous_weights; /* of the last frame */
    float outside;           /* how far the weights of layers lie outside their ranges */

    /* padded_dimension floats each, padding zero */
    float* z;
    float* gradient;
    float* start;          /* z0 at the weights of this frame */
    float* previous_start; /* z0 at those of the last one */
    float* previous_z;     /* answer of the last frame */
    float* first_z;        /* end of a jump's first descent */
    float* trial;
    float* trial_gradient;
    float* direction;
    float* step;
    float* change;
    float* product;
    float* load; /* the frame's dead load; null if the asset has none */

    float* inverse_hessian;  /* padded_dimension squared, symmetric to the bit */
    int is_identity;         /* whether inverse_hessian is the identity */
    float* combined;         /* numbers of the surrogate energy for combined_weights */
    float* combined_weights; /* padded pose count */
    int is_combined;         /* whether `combined` holds anything yet */
    float* scratch;          /* of the surrogate energy */
    float* radial_scratch;   /* of pliant_radial_evaluate */
    double energy;           /* at z */
    uint32_t iterations;
    uint32_t evaluations;
    uint32_t evaluation_limit; /* at which a descent ends: desc.max_evaluations, or the share of it that it may use */
};

/* Memory that the asset's surrogate energy needs. */
pliant_energy_layout pliant_solver_measure_energy(const pliant_asset* asset);

/* Makes `combined` that of solver->weights, if it is not that already: a function of them alone. */
void pliant_solver_combine(pliant_solver* solver);

/* Evaluates the surrogate energy and the load at `z` and counts it. 1 if value and gradient are finite, 0 otherwise: such a
   point counts as +infinity. */
int pliant_solver_evaluate(pliant_solver* solver, const float* z, double* energy, float* gradient);

/* Minimises from solver->z, where energy and gradient are known. LIMIT at desc.max_iterations or at evaluation_limit. */
pliant_status pliant_bfgs_minimise(pliant_solver* solver);

/* Makes the inverse Hessian the identity: in whitened coordinates the right guess without history. */
void pliant_bfgs_forget(pliant_solver* solver);

/* g^T B g, the squared gradient in the metric of the inverse Hessian; direction becomes -B g. */
float pliant_bfgs_direction(pliant_solver* solver);

#endif
