/** @file
   Pliant runtime: nonlinear blending of whole shapes, in real time.

   This header is the manual. C99, needs libc and libm only, compiles as C++11.

   @par What it does
     Opens a baked .pliant asset (a shell or a solid) in place, finds for given weights the elastic blend of the asset's
     poses (a small minimisation, microseconds), and rebuilds vertex positions from it.
   @par What it does not do
     Allocate, read files, log, keep globals, start threads, call back, read a clock. It also does not bake: that is the
     `pliant` tool.

   @par Step by step
     1. Get the file into memory, at an address that is a multiple of 16 (malloc and mmap give that).
     2. pliant_asset_open         once per asset; the view points into your memory, which must outlive it.
     3. pliant_solver_memory      how many bytes one character needs; allocate them where you like.
     4. pliant_solver_init        once per character.
     5. pliant_solve              once per frame and character: weights in, q out.
     6. pliant_reconstruct        q in, positions out, any range of vertices, any stride; split it over threads at will.
        pliant_bounds             q in, a box round all vertices out, without the vertices: for culling.
     7. pliant_normals_compute    positions in, normals out, if you want them; pliant_normals_init once per asset.

   @par Threads
     A pliant_asset is read-only after opening and may be shared. A pliant_solver belongs to one thread at a time. Calls
     on different solvers never touch the same memory.
   @par Determinism
     Compiled without floating-point contraction and fast-math (the CMake project sees to that), the same asset, weights
     and call history give the same bits, whatever the compiler, its optimisation and the width of the processor's vectors.
   @par Machines
     Little-endian with IEEE single and double precision. On a big-endian machine pliant_asset_open answers
     PLIANT_ERROR_VERSION: assets are used in place and would have to be converted first.
   @par Hostile input
     pliant_asset_open accepts any bytes: it returns a result code or an asset that later calls cannot leave, whatever
     its numbers say. Weights may be anything: bad ones get a result code and change nothing. */
#ifndef PLIANT_H
#define PLIANT_H

#include <stddef.h>
#include <stdint.h>

#define PLIANT_VERSION_MAJOR 0 /**< of the library; 0: a new minor version may change this header */
#define PLIANT_VERSION_MINOR 1 /**< of the library, not of the file format */
#define PLIANT_VERSION_PATCH 0 /**< of the library: faults mended, the header as it was */

#ifndef PLIANT_API
#define PLIANT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** What a call answers. Numbered with gaps per family; numbers never change meaning. */
typedef enum pliant_result {
    PLIANT_OK = 0,

    /* the call itself */
    PLIANT_ERROR_ARGUMENT = 10,    /**< a null pointer, an index out of range, a desc not made by its _default function */
    PLIANT_ERROR_MEMORY_SIZE = 11, /**< the memory given is smaller than the _memory function says */
    PLIANT_ERROR_ALIGNMENT = 12,   /**< the blob is not at a multiple of 16 */
    PLIANT_ERROR_ABSENT = 13,      /**< what was asked for is not there: no morph ranges, no asset in the GLB */

    /* the asset (rule numbers of formats/SPEC.md) */
    PLIANT_ERROR_TRUNCATED = 20,  /**< R01, R04: smaller than a header, or not of the size that it states */
    PLIANT_ERROR_NOT_PLIANT = 21, /**< R02: not a .pliant file */
    PLIANT_ERROR_VERSION = 22,    /**< R03, R07: made for another major version or needs a chunk unknown here */
    PLIANT_ERROR_LIMIT = 23,      /**< R05: a count outside its range */
    PLIANT_ERROR_LAYOUT = 24, /**< R06, R07, R09, R14 .. R16: chunks missing, misplaced, of wrong size; reserved bits set */
    PLIANT_ERROR_NUMBER = 25, /**< R10, R13, R17: a number that is not finite or not in its range */
    PLIANT_ERROR_INDEX = 26,  /**< R11: an index past the last vertex; names or polygons that do not add up */
    PLIANT_ERROR_CHECKSUM = 27, /**< R08, R12: damaged in transit */

    /* the weights */
    PLIANT_ERROR_WEIGHT_NOT_FINITE = 40,
    PLIANT_ERROR_WEIGHT_NEGATIVE = 41,
    PLIANT_ERROR_WEIGHT_SUM = 42 /**< all weights are zero */
} pliant_result;

/** One English line for a result, never null. */
PLIANT_API const char* pliant_result_text(pliant_result result);

/** Version of the library as major * 10000 + minor * 100 + patch. */
PLIANT_API uint32_t pliant_version(void);

/* ---------------------------------------------------------------------------------------------------- asset ---- */

/** A view of an asset. It owns nothing and holds pointers into the blob: copy it freely, drop it any time, but keep the
   blob where it is. The fields up to `smoothing_groups` are for you to read, the others are internal. */
typedef struct pliant_asset {
    uint32_t vertex_count;     /**< n: pliant_reconstruct gives this many positions */
    uint32_t triangle_count;   /**< see `triangles` */
    uint32_t dimension;        /**< d: how many reduced coordinates q has */
    uint32_t pose_count;       /**< m: how many weights a blend has */
    float origin[3];           /**< added to every position, in units of the input meshes */
    const uint32_t* triangles; /**< triangle_count x 3 vertex indices, all below boundary_vertex_count */
    uint32_t
        boundary_vertex_count; /**< for a solid, how many vertices are on its boundary: they come first, so that drawing needs
                                        pliant_reconstruct of these only. Else vertex_count */
    const uint32_t*
        source_vertices; /**< for a solid, vertex_count numbers that the vertices had in the input files. Else null:
                                        their order is that of the input */
    const uint32_t*
        smoothing_groups; /**< vertex_count numbers below vertex_count: vertices with the same number lie at one place and share
                             their normal. Null: every vertex has its own */

    /** @cond internal */
    const unsigned char* blob;
    uint64_t blob_size;
    const float* mean;             /**< dimension, padded */
    const float* whitening;        /**< dimension columns, padded */
    const float* pose_coordinates; /**< pose_count rows, padded */
    const void* batches;
    const unsigned char* elements;  /**< start of the ELEM chunk; null with a quartic */
    const float* quartic;           /**< table of pose 0; null with elements */
    uint64_t quartic_floats;        /**< from one pose's table to the next */
    const float* predictor_centres; /**< null without a predictor */
    const float* predictor_coefficients;
    const float* load_coefficients; /**< null without a dead load */
    const float* morph_ranges;      /**< lows, then highs, padded; null without them */
    const float* rest;
    const float* basis;                         /**< null with a compact basis */
    const struct pliant_format_column* columns; /**< of a compact basis; null without */
    const struct pliant_format_tile* tiles;
    const struct pliant_format_field* fields;
    const uint32_t* data;
    const struct pliant_format_interval* bounds; /**< null without clusters */
    uint32_t cluster_count;
    uint32_t batch_count;
    uint32_t predictor_count;
    uint32_t padded_dimension;
    float energy_scale;
    /** @endcond */
} pliant_asset;

/* Flags of pliant_asset_open. */
#define PLIANT_OPEN_DEFAULT 0u          /**< what is always checked, no more */
#define PLIANT_OPEN_VERIFY_CHECKSUMS 1u /**< also compare all checksums: reads the whole blob */

/** Opens the asset at `blob`, `blob_size` bytes. Structure, sizes, indices and the numbers that a frame reads are always
   checked. On an error `*out` is all zero. Cost: linear in the size of the blob without its basis, milliseconds at most. */
PLIANT_API pliant_result pliant_asset_open(pliant_asset* out, const void* blob, size_t blob_size, uint32_t flags);

/** Name of pose `pose` (UTF-8, zero-terminated, in the blob), or null if there is no such pose. */
PLIANT_API const char* pliant_asset_pose_name(const pliant_asset* asset, uint32_t pose);

/** The reduced coordinates (dimension floats) that reproduce pose `pose`, or null if there is no such pose. A weighted sum of
   them with weights of sum 1 is the linear blend: useful to show the difference. */
PLIANT_API const float* pliant_asset_pose_coordinates(const pliant_asset* asset, uint32_t pose);

/** The bytes of a chunk by its tag (formats/pliant_format.h), or null (and *size = 0) if the asset has none. For tools. */
PLIANT_API const void* pliant_asset_chunk(const pliant_asset* asset, uint32_t tag, size_t* size);

/* --------------------------------------------------------------------------------------------------- solver ---- */

/** How to solve. Make it with pliant_solver_desc_default, then change what you like. */
typedef struct pliant_solver_desc {
    uint32_t struct_size;     /**< set by pliant_solver_desc_default, do not change */
    uint32_t max_iterations;  /**< per frame, default 60. 0: the answer is the predictor's in every frame, q = mean + S z0(w)
                                 (the equal-weight average if the asset has none or the stand-in cannot be evaluated
                                 there), for one evaluation, two at most; the status is LIMIT unless that converged */
    uint32_t max_evaluations; /**< per frame, default 120, at least 1, never exceeded: times the cost of one evaluation
                                 (runtime/README.md) it bounds the time of a frame. From 32 up a jump may spend a quarter
                                 of them on a second descent, see below */
    float tolerance;          /**< stop when the gradient, measured in the metric of the inverse Hessian, is below
                                 tolerance * sqrt(energy scale). Default 1e-3, useful range 1e-4 .. 1e-2: finer is
                                 below the noise of single precision */
    float continuity;         /**< weights whose sum of absolute changes (after normalisation) is at most this since the
                                 last frame start from that frame, or further along its path; else from the predictor.
                                 Default 0.1; 0: always from the predictor */
} pliant_solver_desc;

/** The defaults named above. */
PLIANT_API pliant_solver_desc pliant_solver_desc_default(void);

/** State of one character: lives in memory that you gave. */
typedef struct pliant_solver pliant_solver;

/** Bytes that pliant_solver_init needs; 0 if an argument is bad. Typically 16 to 100 KiB; with a quartic stand-in as much as
   one of its tables more, 253 KiB for d = 32. */
PLIANT_API size_t pliant_solver_memory(const pliant_asset* asset, const pliant_solver_desc* desc);

/** Makes a solver in `memory` (any alignment, `memory_size` bytes). The solver keeps pointers into the asset's blob and
   copies the view itself. There is nothing to free: drop the memory when you are done. */
PLIANT_API pliant_result pliant_solver_init(pliant_solver** out, const pliant_asset* asset, const pliant_solver_desc* desc,
                                            void* memory, size_t memory_size);

/** Forgets the past: the next frame is solved as from a new solver, to the same bits. For cuts and teleports. */
PLIANT_API void pliant_solver_reset(pliant_solver* solver);

/** How a frame ended. Every one of them gives a finite q that is not worse than its start: its energy is not above that of
   the start by more than single precision can tell (2e-5 of the asset's energy scale).

   Jumps (the first frame, and weights further away than `continuity`) start from the predictor, or from the equal-weight
   average, z = 0, if that is lower. A descent from the predictor that gets stuck (STALLED, or three quarters of
   max_evaluations spent, with more to gain than noise) is followed by one from z = 0 with what is left of both limits, and the
   lower end counts. So with max_iterations > 0 and max_evaluations > 1 a jump ends, to within that noise, no higher than the
   predictor and no higher than the equal-weight average.
   Not promised: that a converged descent from the predictor ends as low as one from z = 0 would have. Where the stand-in has
   several minima only two whole descents could tell, and the predictor's is the lower one far more often
   (runtime/README.md). */
typedef enum pliant_status {
    PLIANT_STATUS_CONVERGED = 0,
    PLIANT_STATUS_LIMIT = 1,  /**< stopped by max_iterations or max_evaluations; the next frame goes on from here */
    PLIANT_STATUS_STALLED = 2 /**< no step improves any more in single precision, but the gradient is above the tolerance */
} pliant_status;

/** What a frame was: for displays, logs and tests. */
typedef struct pliant_solve_info {
    pliant_status status; /**< how it ended */
    uint32_t iterations;  /**< steps of BFGS */
    uint32_t evaluations; /**< of the stand-in and its gradient, those of the line search included */
    float energy;         /**< of the stand-in, relative to the equal-weight average (so it may be negative) */
    float gradient;       /**< norm as in desc.tolerance, in units of sqrt(energy scale) */
} pliant_solve_info;

/** Blends: `weights` (pose_count floats, each >= 0, any positive sum) in, `q` (dimension floats) out, `info` may be null.
   Only the ratios of the weights matter. Bad weights: a result code; q, info and the solver stay as they are, to the bit.
   Cost: (iterations + a few) evaluations of the stand-in; if the weights have changed since the last frame, combining its
   numbers, linear in the poses whose weight is not zero; and once a frame the asset's dead load and, after a jump, its
   predictor: (pose_count + dimension for each) multiply-adds times the predictor's centres; no allocation, no system call. */
PLIANT_API pliant_result pliant_solve(pliant_solver* solver, const float* weights, float* q, pliant_solve_info* info);

/* ------------------------------------------------------------------------------------------- reconstruction ---- */

/** Positions of vertices first to first+count-1 for the coordinates `q`: position i is written as three floats at
   (char*)positions + i * stride (stride in bytes, at least 12, a multiple of 4), in units of the input meshes. Vertices
   past the last one are not written. Ranges that start at multiples of 64 are fastest; ranges may run on different
   threads. Cost: reads the basis of the vertices once, forwards: about 4 bytes a vertex and dimension if it is compact, 12 if it is in
   single precision (`pliant info`), and 12 more a vertex. */
PLIANT_API void pliant_reconstruct(const pliant_asset* asset, const float* q, uint32_t first, uint32_t count,
                                   float* positions, size_t stride);

/** The same from the first `columns` dimensions of q only, as if the others were zero: faster the fewer there are. Of a compact
   basis they come sorted by how far they move blends. */
PLIANT_API void pliant_reconstruct_columns(const pliant_asset* asset, const float* q, uint32_t columns, uint32_t first,
                                           uint32_t count, float* positions, size_t stride);

/** How few columns pliant_reconstruct_columns needs for this q so that no vertex is further than `error` (in units of the input meshes)
   from where pliant_reconstruct puts it, rounding in single precision apart: exact, for any q. An asset in single precision does not
   know how far its columns reach: there it is all of them. Cost: linear in the dimension. */
PLIANT_API uint32_t pliant_columns_needed(const pliant_asset* asset, const float* q, float error);

/** What a dimension of q does to the shape. */
typedef struct pliant_column {
    float
        reach; /**< no vertex moves further than this per unit of q[column], in units of the input meshes; +infinity if the asset
                    does not know it (single precision) */
    float limit; /**< |q[column]| of the blends that the baker looked at, with a margin; 0 if the asset does not know it */
    float bits;  /**< mean size of a number of the basis in this column */
} pliant_column;

/** Describes dimension `column` of q. PLIANT_ERROR_ARGUMENT if there is none. Cost: linear in the vertices / 64 if compact. */
PLIANT_API pliant_result pliant_asset_column(const pliant_asset* asset, uint32_t column, pliant_column* out);

/** A box round all vertices for the coordinates `q`, whatever they are, in units of the input meshes: every position that
   pliant_reconstruct gives for this q lies inside. On blends it is wider than the shape by 0.1 to 2 %
   of the diagonal a side in the mean, where limbs swing far by up to 10 % (tests/bench/README.md). Cost: 6 * (dimension + 1) multiply-adds for each of at most 256 clusters of vertices, microseconds; for an
   asset of before format 1.3 or baked without clusters that of reconstructing all vertices. PLIANT_ERROR_ARGUMENT for null pointers. */
PLIANT_API pliant_result pliant_bounds(const pliant_asset* asset, const float* q, float lowest[3], float highest[3]);

/* ------------------------------------------------------------------------------------------------------ normals ---- */

/** Who is next to whom: what normals need beside positions. A view into memory that you gave and into the asset's blob, made
   once per asset and shared by all characters and threads. The first two fields and memory_used are for you to read. */
typedef struct pliant_normals {
    uint32_t vertex_count;    /**< the asset's boundary_vertex_count */
    uint32_t neighbour_count; /**< how many words `neighbours` has */
    size_t memory_used; /**< bytes from the start of the memory that stay in use after pliant_normals_init; the rest, about
                                 40 % on usual meshes, may be given back */
    const uint32_t* groups;     /**< null or, per vertex, the group that it belongs to; without groups a vertex is its own */
    const uint32_t* starts;     /**< of group g the words starts[g] .. starts[g+1]-1 */
    const uint32_t* neighbours; /**< neighbours in order; bit 31 marks the first one of a run */
} pliant_normals;

/** Bytes that pliant_normals_init needs: 4 for a vertex and 24 for a triangle; 0 if the argument is bad. */
PLIANT_API size_t pliant_normals_memory(const pliant_asset* asset);

/** Builds the adjacency of `asset` in `memory` (any alignment). Cost: linear, some 10 ms for 100,000 triangles. Nothing to free. */
PLIANT_API pliant_result pliant_normals_init(pliant_normals* out, const pliant_asset* asset, void* memory,
                                             size_t memory_size);

/** Normals of vertices first to first+count-1: three floats each, of length 1, at (char*)out + i * out_stride. `positions` are those of
   ALL vertices below vertex_count, `stride` apart, position of vertex 0 first: finish pliant_reconstruct, then compute normals.
   Strides are at least 12 and multiples of 4; with the right offset and stride positions and normals may lie in one vertex
   buffer. Vertices past the last one are not written. Ranges may run on different threads, any cut gives the same bits.
   A normal is the sum of the normals of the triangles at the vertex (at all vertices of its group) weighted by their areas. Where
   that sum is zero or not finite (no triangle, only triangles without area, positions that are not numbers) it is (0, 0, 1).
   Cost: runtime/README.md. */
PLIANT_API void pliant_normals_compute(const pliant_normals* normals, const float* positions, size_t stride, uint32_t first,
                                       uint32_t count, float* out, size_t out_stride);

/* -------------------------------------------------------------------------------------------- morph targets ---- */

/** For engines that draw a `pliant export --morph` GLB with morph targets of their own: the weights (dimension floats, in the
   order of the targets) that make them draw the shape of `q`, w_j = (q_j - low_j) / (high_j - low_j). They are in [0,1] wherever
   the bake has looked, with a margin; they are not clamped, so that an engine that does not clamp either draws the very shape.
   `weights` may be `q`. PLIANT_ERROR_ABSENT: the asset has no ranges (baked before format 1.3); the GLB's extras have those
   that it was exported with. Cost: dimension divisions. */
PLIANT_API pliant_result pliant_morph_weights(const pliant_asset* asset, const float* q, float* weights);

/** Finds the asset inside a `pliant export --embed` GLB of `glb_size` bytes: it is the first thing in the GLB's binary chunk
   (formats/SPEC.md, section 7). On success glb + *offset is what to give to pliant_asset_open, with *size; *offset is a multiple
   of 4096 in files that we write, so the blob is aligned if `glb` is. Accepts any bytes: PLIANT_ERROR_NOT_PLIANT if they are no
   GLB, PLIANT_ERROR_TRUNCATED if it is cut off, PLIANT_ERROR_ABSENT if no asset is inside; *offset and *size are 0 then. It only
   finds: pliant_asset_open does the checking. Cost: reads some hundred bytes. */
PLIANT_API pliant_result pliant_glb_find(const void* glb, size_t glb_size, size_t* offset, size_t* size);

#ifdef __cplusplus
}
#endif
#endif
