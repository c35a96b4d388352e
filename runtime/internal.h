/* What the files of the runtime share. Not installed, not part of the API. */
#ifndef PLIANT_INTERNAL_H
#define PLIANT_INTERNAL_H

#include "pliant.h"

#include "../formats/pliant_format.h"

#include <string.h>

/* Vector loops run over this many floats, a constant, so that every build adds in the same order whatever its vectors'
   width: 16 lanes are four SSE registers, two of AVX, one of AVX-512. */
#define PLIANT_LANES PLIANT_FORMAT_LANES

#if defined(__GNUC__) || defined(__clang__) || (defined(__STDC_VERSION__) && __STDC_VERSION__ >= 199901L)
#define PLIANT_RESTRICT restrict
#else
#define PLIANT_RESTRICT
#endif

static inline size_t pliant_pad_lanes(size_t count) { return (count + (PLIANT_LANES - 1)) & ~(size_t)(PLIANT_LANES - 1); }

/* True unless `value` is an infinity or not a number. By its bits, so that a host that compiles us with finite-math
   assumptions does not lose the check. */
static inline int pliant_is_finite(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (bits & 0x7F800000u) != 0x7F800000u;
}

/* --------------------------------------------------------------------------------------------- stand-in energy ---- */

/* Memory that an evaluation of an asset's elements needs, in floats; every array starts at a multiple of 64 bytes. */
typedef struct pliant_elements_layout {
    uint64_t combined_floats; /* all batches' per-pose numbers, combined for the weights of the frame */
    uint64_t scratch_floats;  /* one block of differences, and as much for the derivatives by them */
} pliant_elements_layout;

pliant_elements_layout pliant_elements_measure(const pliant_asset* asset);

/* Combines the per-pose numbers of all batches (those of ARAP excepted, which are not linear) for normalised weights. */
void pliant_elements_combine(const pliant_asset* asset, const float* weights, float* combined);

/* Value and gradient of the stand-in at z. Arrays of z and gradient have padded_dimension floats; the padding of the
   gradient comes back as zero. The value may come back as infinity or not-a-number: the caller decides. */
double pliant_elements_evaluate(const pliant_asset* asset, const float* weights, const float* combined, const float* z,
                                float* gradient, float* scratch);

/* One group of PLIANT_LANES elements. Row r of an array lies at `r * its stride`. */
typedef struct pliant_element_group {
    const float* rows; /* differences at z = 0 */
    const float* fixed;
    const float* numbers; /* combined pose numbers; for ARAP those of pose 0 as stored */
    size_t stride;        /* of rows, fixed and numbers: the padded element count of the batch */
    const float* change;  /* differences minus those at z = 0 */
    size_t block_stride;  /* of change, and of the forces written: derivatives by the differences */
} pliant_element_group;

/* Each writes the forces of its elements and adds their energy to energy[PLIANT_LANES]. */
void pliant_hinge_evaluate(const pliant_element_group* group, float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy);
void pliant_face_neo_hookean_evaluate(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                                      float* PLIANT_RESTRICT energy);
void pliant_face_stvk_evaluate(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                               float* PLIANT_RESTRICT energy);
void pliant_face_edge_evaluate(const pliant_element_group* group, float* PLIANT_RESTRICT force,
                               float* PLIANT_RESTRICT energy);

/* What an ARAP cell needs beside its group. The numbers of pose k lie pose_stride floats behind those of pose k-1. */
typedef struct pliant_arap_poses {
    uint32_t valence;
    uint32_t edge_count;
    const float* weights;
    uint32_t pose_count;
    size_t pose_stride;
} pliant_arap_poses;

void pliant_arap_cell_evaluate(const pliant_element_group* group, const pliant_arap_poses* poses,
                               float* PLIANT_RESTRICT force, float* PLIANT_RESTRICT energy);

/* ----------------------------------------------------------------------------------------- functions of the weights ---- */

/* The start z0(w) and the dead load c(w) for normalised weights, padded_dimension floats each, padding zero; 0 where the asset
   has none. Either may be null: not wanted. `load` must be null if the asset has none. Together they share one pass over the
   centres and cost centre_count * (pose_count + dimension for each) multiply-adds. */
void pliant_radial_evaluate(const pliant_asset* asset, const float* weights, float* start, float* load);

/* ------------------------------------------------------------------------------------------------------- solver ---- */

/* Below this part of the energy scale differences of energies are rounding: a sum of some hundred single-precision terms
   of the size of the scale is known to about 1e-5 of it. */
#define PLIANT_ENERGY_NOISE 2e-5

struct pliant_solver {
    uint32_t magic; /* says that this memory was initialised */
    pliant_solver_desc desc;
    pliant_asset asset;

    int history;             /* how many frames before this one are known: 0, 1, 2 (then both steps were small) */
    float* weights;          /* of this frame, normalised; padded pose count */
    float* previous_weights; /* of the last frame */
    float* earlier_weights;  /* of the frame before it */

    /* padded_dimension floats each, padding zero */
    float* z;
    float* gradient;
    float* previous_z; /* answer of the last frame */
    float* earlier_z;  /* answer of the frame before it */
    float* trial;
    float* trial_gradient;
    float* direction;
    float* step;
    float* change;
    float* product;
    float* load; /* the frame's dead load; null if the asset has none */

    float* inverse_hessian; /* padded_dimension squared, symmetric to the bit */
    int is_identity;        /* whether inverse_hessian is the identity */
    float* combined;
    float* scratch;
    double energy; /* at z */
    uint32_t iterations;
    uint32_t evaluations;
    uint32_t evaluation_limit; /* at which a descent ends: desc.max_evaluations, or the share of it that it may use */
};

/* Evaluates elements and load at `z` and counts it. 1 if value and gradient are finite, 0 otherwise: such a point counts as +infinity. */
int pliant_solver_evaluate(pliant_solver* solver, const float* z, double* energy, float* gradient);

/* Minimises from solver->z, where energy and gradient are known. LIMIT at desc.max_iterations or at evaluation_limit. */
pliant_status pliant_bfgs_minimise(pliant_solver* solver);

/* Makes the inverse Hessian the identity: in whitened coordinates the right guess without history. */
void pliant_bfgs_forget(pliant_solver* solver);

/* g^T B g, the squared gradient in the metric of the inverse Hessian; direction becomes -B g. */
float pliant_bfgs_direction(pliant_solver* solver);

#endif
