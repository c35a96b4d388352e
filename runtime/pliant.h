/** @file
   Pliant runtime: nonlinear blending of whole shapes, in real time.

   This header is the manual. The library is C99, needs libc and libm only, and compiles as C++11.

   @par What it does
     It opens a baked .pliant asset (a shell or a solid) in place. For given weights it finds the elastic blend of the
     asset's poses, by a small minimisation that takes microseconds. It then rebuilds vertex positions and normals. A blend
     is an average of the asset's poses, or a rest shape with layers on it.
   @par What it does not do
     It does not allocate, read files, log, keep globals, start threads, call back or read a clock. It does not bake:
     the `pliant` tool does.

   @par Terms
     - q: the reduced coordinates of a shape (d floats); positions are linear in q.
     - z: the solver's own coordinates; q = mean + S z, with the asset's mean and whitening matrix S.
     - Average: the blend of poses whose weights say how near it lies to each. Weights are >= 0, only their ratios matter.
     - Layers: the blend of a rest shape (pose 0) and layers on it (poses 1 .. pose_count - 1), such as the expressions of a
       face. A weight says how much of a layer is added: 0 none, 1 all of it, as the input has it, 2 twice as much, -1 the
       opposite. Weights are any finite numbers, negative ones too. They add up and are not normalised. With all weights
       zero the blend is the rest shape. An asset is of averages or of layers (`has_layers`).
     - Unreduced average: the exact blend on the full mesh, as the baker computes it.
     - Surrogate energy: what the solver minimises instead of the full elastic energy: a few elements, or one quartic.
     - Predictor: a function of the weights (radial basis functions) that estimates the minimiser; the solver starts there.
     - Dead load: a force that depends on the weights only; it moves the surrogate's minimisers to the unreduced averages.

   @par Step by step
     1. Load the file into memory, at an address that is a multiple of 16 (malloc and mmap return such addresses).
     2. pliant_asset_open         once per asset; the view points into your memory, which must outlive it.
     3. pliant_solver_memory      returns the number of bytes that one character needs; allocate them where you like.
     4. pliant_solver_init        once per character.
     5. pliant_solve              once per frame and character: weights in, q out. pliant_asset_weight describes the weights.
     6. pliant_reconstruct        q in, positions out, any range of vertices, any stride; split it over threads at will.
        pliant_bounds             q in, a bounding box out, without the vertices: for culling.
     7. pliant_normals_compute    positions in, normals out, if you want them; pliant_normals_init once per asset.

   @par Threads
     A pliant_asset is read-only after opening and may be shared by threads. A pliant_solver belongs to one thread at a
     time. Calls on different solvers never touch the same memory.
   @par Determinism
     The same asset, weights and call history give the same bits, with gcc and clang, at any optimisation level and any
     vector width of the processor. The library must be compiled without floating-point contraction and fast-math, as
     the CMake project does.
   @par Platforms
     Little-endian, with IEEE single and double precision; not the x87, which computes in another. On a big-endian machine
     pliant_asset_open returns PLIANT_ERROR_VERSION: assets are used in place and would have to be converted first.
   @par Untrusted input
     pliant_asset_open accepts any bytes. It returns an error code, or an asset on which no later call reads or writes out
     of bounds, whatever numbers it holds. Weights may be anything: invalid ones return an error code and change nothing. */
#ifndef PLIANT_H
#define PLIANT_H

#include <stddef.h>
#include <stdint.h>

#define PLIANT_VERSION_MAJOR 0 /**< library version; while it is 0, a new minor version may change this header */
#define PLIANT_VERSION_MINOR 1 /**< library version, not the version of the file format */
#define PLIANT_VERSION_PATCH 0 /**< library version: bug fixes only, this header is unchanged */

#ifndef PLIANT_API
#define PLIANT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Result of a call. Each family has a range of numbers; a number never changes its meaning. */
typedef enum pliant_result {
    PLIANT_OK = 0,

    /* the call */

    /** A null pointer, an index out of range, or a desc that was not made by its _default or _init function. */
    PLIANT_ERROR_ARGUMENT = 10,
    PLIANT_ERROR_MEMORY_SIZE = 11, /**< the memory is smaller than the _memory function requires */
    PLIANT_ERROR_ALIGNMENT = 12,   /**< the address of the blob is not a multiple of 16 */
    PLIANT_ERROR_ABSENT = 13,      /**< the asset has no morph ranges, or the GLB holds no asset */

    /* the asset; R01 etc. are rule numbers of formats/SPEC.md */

    PLIANT_ERROR_TRUNCATED = 20,  /**< R01, R04: smaller than a header, or not of the size that the header states */
    PLIANT_ERROR_NOT_PLIANT = 21, /**< R02: not a .pliant file */
    PLIANT_ERROR_VERSION = 22,    /**< R03, R07: another major version, or an unknown chunk that is required */
    PLIANT_ERROR_LIMIT = 23,      /**< R05: a count outside its range; groups of normals that are too large */
    /** R06, R07, R09, R14 .. R16, R18, R21, R23, R24: a chunk is missing, misplaced, of the wrong size or beside one that
       excludes it, or reserved bits are set. */
    PLIANT_ERROR_LAYOUT = 24,
    PLIANT_ERROR_NUMBER = 25, /**< R10, R13, R17, R19, R20, R23, R24: a number that is not finite or out of range */
    PLIANT_ERROR_INDEX = 26,  /**< R11, R22, R24: an index out of range or out of order, or inconsistent names or polygons */
    PLIANT_ERROR_CHECKSUM = 27, /**< R08, R12: a checksum does not match, the file was damaged */

    /* the weights */

    PLIANT_ERROR_WEIGHT_NOT_FINITE = 40, /**< a weight is infinite or not a number */
    PLIANT_ERROR_WEIGHT_NEGATIVE = 41,   /**< a weight of an average is below zero */
    PLIANT_ERROR_WEIGHT_SUM = 42         /**< all weights of an average are zero */
} pliant_result;

/** One line of English text that describes a result: a static string, never null. */
PLIANT_API const char* pliant_result_text(pliant_result result);

/** Version of the library: major * 10000 + minor * 100 + patch. */
PLIANT_API uint32_t pliant_version(void);

/* ---------------------------------------------------------------------------------------------------- asset ---- */

/** A view of an asset. It owns nothing and holds pointers into the blob. Copy it freely and drop it at any time, but keep
   the blob alive and in place. The fields up to `smoothing_groups` are yours to read; the others are internal. */
typedef struct pliant_asset {
    uint32_t vertex_count;     /**< n: the number of positions that pliant_reconstruct can write */
    uint32_t triangle_count;   /**< the number of triangles in `triangles` */
    uint32_t dimension;        /**< d: the number of reduced coordinates in q */
    uint32_t pose_count;       /**< m: the number of poses; of layers the rest shape, which is pose 0, and the layers */
    uint32_t weight_count;     /**< the number of weights of a blend: pose_count, or of layers pose_count - 1, 1 .. 64 */
    uint32_t has_layers;       /**< 1 if the weights add layers to pose 0, 0 if the blend is an average of the poses */
    float origin[3];           /**< added to every position, in units of the input meshes */
    const uint32_t* triangles; /**< triangle_count x 3 vertex indices, all below boundary_vertex_count */
    /** For a solid, the number of vertices on its boundary. They come first, so drawing needs pliant_reconstruct of these
       vertices only. Otherwise vertex_count. */
    uint32_t boundary_vertex_count;
    /** For a solid, the index that each of the vertex_count vertices had in the input files. Otherwise null: the vertices
       are in the order of the input. */
    const uint32_t* source_vertices;
    /** One group number below vertex_count for each vertex. Vertices of one group lie at the same place and share their
       normal. Null: every vertex has a normal of its own. */
    const uint32_t* smoothing_groups;

    /** @cond internal */
    const struct pliant_kernels* kernels; /**< those of the processor that opened it */
    const unsigned char* blob;
    uint64_t blob_size;
    const float* mean;             /**< dimension, padded */
    const float* whitening;        /**< dimension columns, padded */
    const float* pose_coordinates; /**< pose_count rows, padded */
    const void* batches;
    const unsigned char* elements;            /**< start of the ELEM chunk; null with a quartic */
    const struct pliant_format_layer* layers; /**< weight_count of them; null if there are none */
    const float* quartic;                     /**< table of pose 0; null with elements */
    uint64_t quartic_floats;                  /**< from one pose's table to the next */
    const float* predictor_centres;           /**< null without a predictor */
    const float* predictor_coefficients;
    const float* load_coefficients;             /**< null without a dead load */
    const float* morph_ranges;                  /**< lows, then highs, padded; null without them */
    const float* rest;                          /**< null with a factored basis */
    const float* basis;                         /**< null with a compact or factored basis */
    const struct pliant_format_column* columns; /**< of a compact or factored basis; null without */
    const struct pliant_format_tile* tiles;     /**< of a compact basis; null without */
    const struct pliant_format_field* fields;
    const uint32_t* data;
    const struct pliant_format_product* products; /**< tiles of a factored basis; null without */
    const uint32_t* blocks;                       /**< the first of them in each block, and their number */
    uint64_t data_words;                          /**< of a factored basis */
    uint32_t block_vertices;
    const struct pliant_format_interval* bounds; /**< null without clusters */
    uint32_t cluster_count;
    uint32_t batch_count;
    uint32_t predictor_count;
    uint32_t padded_dimension;
    float energy_scale;
    /** @endcond */
} pliant_asset;

/* Flags of pliant_asset_open. */
#define PLIANT_OPEN_DEFAULT 0u          /**< only the checks that are always made */
#define PLIANT_OPEN_VERIFY_CHECKSUMS 1u /**< also compare all checksums, which reads the whole blob */

/** Opens the asset of `blob_size` bytes at `blob`, whose address is a multiple of 16. Always checks structure, sizes,
   indices and the numbers that a frame reads. On an error `*out` is all zero. The blob stays yours.
   Cost: linear in the size of the blob without its basis, milliseconds at most. */
PLIANT_API pliant_result pliant_asset_open(pliant_asset* out, const void* blob, size_t blob_size, uint32_t flags);

/** Name of pose `pose` (UTF-8, zero-terminated, inside the blob), or null if there is no such pose. */
PLIANT_API const char* pliant_asset_pose_name(const pliant_asset* asset, uint32_t pose);

/** The reduced coordinates (dimension floats, inside the blob) that reproduce pose `pose`, or null if there is no such
   pose. pliant_solve() with all weight on a pose ends near them: within its tolerance. The linear blend, to show the
   difference, is the sum of w_k c_k over these vectors c_k, with weights w of sum 1; of layers it is c_0 + the sum of v_k
   (c_k - c_0) over the layers k = 1 .. weight_count, with weights[k - 1] as v_k. */
PLIANT_API const float* pliant_asset_pose_coordinates(const pliant_asset* asset, uint32_t pose);

/** A weight of a blend. */
typedef struct pliant_weight {
    const char* name; /**< of the pose or layer that it belongs to: UTF-8, zero-terminated, inside the blob */
    /** The low end of the range of weights whose blends the baker has measured; 0 of averages, for weights of sum 1. Not a
       limit: see pliant_solve_info.outside. */
    float low;
    float high;    /**< the high end; 1 of averages */
    float initial; /**< the weight to start with: inside the range; of averages 1 / weight_count */
} pliant_weight;

/** Describes weight `index` of pliant_solve: of averages that of pose `index`, of layers that of pose `index` + 1, a layer.
   PLIANT_ERROR_ARGUMENT if there is no such weight, and *out is unchanged. For bindings and tools that offer sliders. Cost:
   linear in the length of the names before it. */
PLIANT_API pliant_result pliant_asset_weight(const pliant_asset* asset, uint32_t index, pliant_weight* out);

/* For other languages, which cannot read the struct: its size, for the memory of an asset (aligned as
   malloc does), and its fields. All are 0 or null
   for a null asset. */

PLIANT_API size_t pliant_asset_size(void);                                               /**< bytes of a pliant_asset */
PLIANT_API uint32_t pliant_asset_get_vertex_count(const pliant_asset* asset);            /**< vertex_count */
PLIANT_API uint32_t pliant_asset_get_boundary_vertex_count(const pliant_asset* asset);   /**< boundary_vertex_count */
PLIANT_API uint32_t pliant_asset_get_triangle_count(const pliant_asset* asset);          /**< triangle_count */
PLIANT_API uint32_t pliant_asset_get_dimension(const pliant_asset* asset);               /**< dimension */
PLIANT_API uint32_t pliant_asset_get_pose_count(const pliant_asset* asset);              /**< pose_count */
PLIANT_API uint32_t pliant_asset_get_weight_count(const pliant_asset* asset);            /**< weight_count */
PLIANT_API uint32_t pliant_asset_get_has_layers(const pliant_asset* asset);              /**< has_layers */
PLIANT_API const float* pliant_asset_get_origin(const pliant_asset* asset);              /**< origin, inside the asset */
PLIANT_API const uint32_t* pliant_asset_get_triangles(const pliant_asset* asset);        /**< triangles */
PLIANT_API const uint32_t* pliant_asset_get_source_vertices(const pliant_asset* asset);  /**< source_vertices */
PLIANT_API const uint32_t* pliant_asset_get_smoothing_groups(const pliant_asset* asset); /**< smoothing_groups */

/** The bytes of the chunk with tag `tag` (formats/pliant_format.h), inside the blob; their number in `*size`. Null and
   *size = 0 if the asset has no such chunk. For tools. */
PLIANT_API const void* pliant_asset_chunk(const pliant_asset* asset, uint32_t tag, size_t* size);

/* --------------------------------------------------------------------------------------------------- solver ---- */

/** Settings of a solver. Make it with pliant_solver_desc_default, then change what you like. */
typedef struct pliant_solver_desc {
    uint32_t struct_size; /**< set by pliant_solver_desc_default, do not change */
    /** Largest number of iterations per frame, default 60. With 0 every frame returns the answer of the predictor,
       q = mean + S z0(w), or the equal-weight average (of layers the rest shape) if the asset has no predictor or the
       surrogate energy cannot be evaluated there. That costs one evaluation, at most two; the status is LIMIT unless that
       point has converged. */
    uint32_t max_iterations;
    /** Largest number of evaluations per frame, default 120, at least 1, never exceeded. Multiply it by the cost of one
       evaluation (runtime/README.md) to bound the time of a frame. From 32 up, a jump may spend a quarter of them on a
       second descent (see pliant_status). */
    uint32_t max_evaluations;
    /** The solver stops when the norm of the gradient, in the metric of the inverse Hessian, is below
       tolerance * sqrt(energy scale). Default 1e-3, useful range 1e-4 .. 1e-2: finer values are below the noise of
       single precision. */
    float tolerance;
    /** Largest change of the weights since the last frame for which the solver starts from that frame, moved by the change
       of the predictor. For larger changes it starts from the predictor. The change of averages is the sum of absolute
       differences after normalisation. That of layers, any number of which may move at the same time, is the largest
       absolute difference. Default 0.1; with 0 it always starts from the predictor. */
    float continuity;
} pliant_solver_desc;

/** The defaults named above. */
PLIANT_API pliant_solver_desc pliant_solver_desc_default(void);

/** The same, written to `*out`: for languages that cannot take a struct by value. */
PLIANT_API void pliant_solver_desc_init(pliant_solver_desc* out);

/** State of one character; it lives in memory that you provide. */
typedef struct pliant_solver pliant_solver;

/** Number of bytes that pliant_solver_init needs; 0 if an argument is invalid. Typically 16 to 100 KiB. A quartic surrogate
   energy adds the size of one of its tables: 253 KiB for d = 32. */
PLIANT_API size_t pliant_solver_memory(const pliant_asset* asset, const pliant_solver_desc* desc);

/** Makes a solver in `memory` (any alignment, `memory_size` bytes). The solver copies the view and keeps pointers into the
   asset's blob. There is nothing to free: drop the memory when you are done. Until then it must not move: a copy of it is
   good only when it is put back at the same place. */
PLIANT_API pliant_result pliant_solver_init(pliant_solver** out, const pliant_asset* asset, const pliant_solver_desc* desc,
                                            void* memory, size_t memory_size);

/** Discards the history: the next frame gives the same bits as a new solver would. For cuts and teleports. */
PLIANT_API void pliant_solver_reset(pliant_solver* solver);

/** How the solution of a frame ended. Every status comes with a finite q that is not worse than its start: its energy
   exceeds that of the start by no more than the noise of single precision (2e-5 of the asset's energy scale).

   A jump is the first frame, or a change of the weights beyond `continuity`. It starts from the predictor, or from the
   equal-weight average (z = 0; of layers the rest shape, here and below) if the energy is lower there. A descent from the
   predictor is stuck if it ends with STALLED or has used three quarters of max_evaluations, and the energy could still fall
   by more than noise. Then a second descent starts from z = 0, within what is left of both limits, and the lower end is
   returned. So with max_iterations > 0 and max_evaluations > 1 a jump ends, up to that noise, no higher than the predictor
   and no higher than the equal-weight average (of layers with weights up to 1e3: rounding may exceed that noise beyond).

   Not guaranteed: that a converged descent from the predictor ends as low as one from z = 0 would. Where the surrogate
   energy has several minima, only two full descents could tell; the predictor leads to the lower one far more often
   (runtime/README.md). */
typedef enum pliant_status {
    PLIANT_STATUS_CONVERGED = 0, /**< the gradient is below the tolerance */
    PLIANT_STATUS_LIMIT = 1,     /**< stopped by max_iterations or max_evaluations; the next frame continues from here */
    PLIANT_STATUS_STALLED = 2    /**< no step improves q in single precision, but the gradient is above the tolerance */
} pliant_status;

/** Statistics of one frame, for displays, logs and tests. */
typedef struct pliant_solve_info {
    pliant_status status; /**< how the frame ended */
    uint32_t iterations;  /**< BFGS steps */
    uint32_t evaluations; /**< evaluations of the surrogate energy and its gradient, including those of line searches */
    float energy;         /**< surrogate energy relative to z = 0 (see pliant_status), so it may be negative */
    float gradient;       /**< norm as in pliant_solver_desc.tolerance, in units of sqrt(energy scale) */
    /** How far the weights of layers lie outside the ranges that the baker has measured: the largest of (v - high) / (high -
       low) and (low - v) / (high - low) over the layers. 0 if all are inside, and for averages. The blend outside is what
       the surrogate energy says, and its error is unknown: it tends to grow with this number. */
    float outside;
} pliant_solve_info;

/** Blends: `weights` (weight_count floats) in, `q` (dimension floats) out; `info` may be null. Weights of averages are >= 0
   with any positive sum, and only their ratios matter. Weights of layers are any finite numbers: weights[k] is that of pose
   k + 1, may be negative, above 1 and outside its range, and all may be 0. Weights so large that the surrogate energy
   cannot be evaluated give the rest shape, and STALLED. If weights are invalid it returns an error, and q, info and the
   solver keep their exact bits. It makes no allocation and no system call.
   Cost: if the weights are those of the last frame and that one converged, dimension squared multiply-adds. Otherwise one
   combination of the surrogate energy's numbers, linear in the number of poses with a weight other than zero (of layers
   linear in the elements that these change, and at most the time of one evaluation for the new rest states); predictor and
   dead load, (pose_count + 2 * dimension) multiply-adds for each centre of the predictor, of layers pose_count more; and
   (iterations + 1) evaluations of the surrogate energy, or a few more. */
PLIANT_API pliant_result pliant_solve(pliant_solver* solver, const float* weights, float* q, pliant_solve_info* info);

/* ------------------------------------------------------------------------------------------- reconstruction ---- */

/** Positions of vertices first .. first+count-1 for the coordinates `q` (dimension floats), in units of the input meshes.
   Position i is written as three floats at (char*)positions + i * stride, where i counts from 0 at vertex `first`. `stride`
   is in bytes, at least 12 and a multiple of 4. Vertices from vertex_count on are not written. Ranges that start at
   multiples of pliant_range_unit are fastest; ranges may run on different threads.
   Cost: reads the basis of the vertices once: per vertex and dimension 1.5 to 7 bytes of a factored basis (fewer the more
   dimensions there are), about 4 bytes of a compact one, or 12 bytes in single precision (`pliant info`); beside the last
   two 12 bytes per vertex. */
PLIANT_API void pliant_reconstruct(const pliant_asset* asset, const float* q, uint32_t first, uint32_t count,
                                   float* positions, size_t stride);

/** The number of consecutive vertices that are rebuilt together, 16 .. 65536: ranges on different threads should start at
   multiples of it. Other ranges give the same positions, but each of them costs as much as the whole units that it touches,
   where the basis is factored. 0 if `asset` is not open. */
PLIANT_API uint32_t pliant_range_unit(const pliant_asset* asset);

/** As pliant_reconstruct, from the first `columns` dimensions of q only, as if the others were zero. Fewer columns take less
   time. The columns of a compact basis are sorted by how far they move blends, the largest first. */
PLIANT_API void pliant_reconstruct_columns(const pliant_asset* asset, const float* q, uint32_t columns, uint32_t first,
                                           uint32_t count, float* positions, size_t stride);

/** The number of columns that pliant_reconstruct_columns needs for this q, so that no vertex is further than `error` (in
   units of the input meshes) from its place by pliant_reconstruct. The bound holds for any q, up to rounding in single
   precision. For an asset in single precision the result is the dimension, since it does not store how far its columns
   reach. Cost: linear in the dimension. */
PLIANT_API uint32_t pliant_columns_needed(const pliant_asset* asset, const float* q, float error);

/** The effect of one dimension of q on the shape. */
typedef struct pliant_column {
    /** No vertex moves further than this per unit of q[column], in units of the input meshes. +infinity if the asset does
       not store it (single precision). */
    float reach;
    float limit; /**< largest |q[column]| of the averages and poses that the basis was stored for, plus a margin: blends
                    that are far from their averages exceed it; 0 if not stored */
    float bits;  /**< mean number of bits of a number of the basis in this column; 32 in single precision */
} pliant_column;

/** Describes dimension `column` of q. PLIANT_ERROR_ARGUMENT if there is no such dimension. Cost: vertex_count / 64 additions
   for a compact basis. */
PLIANT_API pliant_result pliant_asset_column(const pliant_asset* asset, uint32_t column, pliant_column* out);

/** A bounding box of all vertices for any coordinates `q`, in units of the input meshes: every position that
   pliant_reconstruct writes for this q lies inside it. Conservative: of meshes with thousands of vertices each side
   overshoots by 0.1 to 4 % of the diagonal on average, by up to 12 % where limbs swing far (tests/bench/README.md). It
   overshoots by more where a sheet folds, and on meshes with a few hundred vertices, which have few clusters. Positions of
   a damaged asset that are not numbers are left out, and so are those that overflow single precision.
   Cost: 6 * (dimension + 1) multiply-adds for each of at most 256 clusters of vertices, microseconds. Without clusters
   (for one, in assets older than format 1.3) it costs as much as reconstructing all vertices.
   PLIANT_ERROR_ARGUMENT for null pointers. */
PLIANT_API pliant_result pliant_bounds(const pliant_asset* asset, const float* q, float lowest[3], float highest[3]);

/* ------------------------------------------------------------------------------------------------------ normals ---- */

/** The adjacency of the triangles: what normals need besides positions. A view into memory that you provide and into the
   asset's blob, made once per asset and shared by all characters and threads. `vertex_count`, `neighbour_count` and
   `memory_used` are yours to read; the others are internal. */
typedef struct pliant_normals {
    uint32_t vertex_count;    /**< the asset's boundary_vertex_count */
    uint32_t neighbour_count; /**< number of words in `neighbours` */
    /** Number of bytes from the start of the memory that stay in use after pliant_normals_init. The rest, about 40 % for
       typical meshes, may be returned to your allocator. */
    size_t memory_used;
    const uint32_t* groups;     /**< the group of each vertex; null without groups: every vertex is a group of its own */
    const uint32_t* starts;     /**< group g has the words starts[g] .. starts[g+1]-1 of `neighbours` */
    const uint32_t* neighbours; /**< neighbours in order; bit 31 marks the first one of a run */
    /** @cond internal */
    const struct pliant_kernels* kernels;
    /** @endcond */
} pliant_normals;

/** Bytes of a pliant_normals: for other languages. */
PLIANT_API size_t pliant_normals_size(void);

/** Number of bytes that pliant_normals_init needs: 4 per vertex and 24 per triangle; 0 if the argument is invalid. */
PLIANT_API size_t pliant_normals_memory(const pliant_asset* asset);

/** Builds the adjacency of `asset` in `memory` (any alignment, `memory_size` bytes). Memory and blob must outlive it.
   There is nothing to free. PLIANT_ERROR_LIMIT: the vertices of all groups together would read more than 2^22 neighbours,
   beside 256 times as many as there are; `pliant bake` puts at most 256 vertices into a group. Cost: linear, some 10 ms for
   100,000 triangles of a usual mesh, more where each vertex has dozens of triangles. */
PLIANT_API pliant_result pliant_normals_init(pliant_normals* out, const pliant_asset* asset, void* memory,
                                             size_t memory_size);

/** Normals of vertices first .. first+count-1: three floats each, of length 1, the one of vertex `first` at `out`, the next
   ones `out_stride` bytes apart. `positions` holds the positions of ALL vertices below vertex_count, `stride` bytes apart,
   starting with vertex 0: finish pliant_reconstruct before you compute normals. Both strides are at least 12 and multiples
   of 4, so positions and normals may be interleaved in one vertex buffer. Vertices from vertex_count on are not written.
   Ranges may run on different threads; the bits do not depend on how the vertices are divided into ranges.
   A normal is the sum of the normals of the triangles at the vertex (at all vertices of its group), weighted by area. If
   that sum is zero or not finite (no triangle, only triangles without area, positions that are not finite), the normal is
   (0, 0, 1). Cost: runtime/README.md. */
PLIANT_API void pliant_normals_compute(const pliant_normals* normals, const float* positions, size_t stride, uint32_t first,
                                       uint32_t count, float* out, size_t out_stride);

/* -------------------------------------------------------------------------------------------- morph targets ---- */

/** Morph target weights for engines that draw a `pliant export --morph` GLB. With `weights` (dimension floats, in the order
   of the targets) the engine draws the shape of `q`: w_j = (q_j - low_j) / (high_j - low_j). They lie in [0,1] for all
   blends that the baker examined, with a margin. They are not clamped: an engine that does not clamp them either draws the
   exact shape for any q. `weights` may be the same array as `q`.
   PLIANT_ERROR_ABSENT: the asset has no ranges (older than format 1.3); the GLB's extras hold the ranges that it was
   exported with. Cost: dimension divisions. */
PLIANT_API pliant_result pliant_morph_weights(const pliant_asset* asset, const float* q, float* weights);

/** Finds the asset inside a `pliant export --embed` GLB of `glb_size` bytes. The asset is the first item in the GLB's binary
   chunk (formats/SPEC.md, section 7). On success pass glb + *offset and *size to pliant_asset_open. The Pliant tool writes
   *offset as a multiple of 4096, so the blob is aligned if `glb` is. Accepts any bytes: PLIANT_ERROR_NOT_PLIANT if they are
   no GLB, PLIANT_ERROR_TRUNCATED if the GLB is cut off, PLIANT_ERROR_ABSENT if it holds no asset; *offset and *size are 0
   then. This function does not check the asset: pliant_asset_open does. Cost: reads some hundred bytes. */
PLIANT_API pliant_result pliant_glb_find(const void* glb, size_t glb_size, size_t* offset, size_t* size);

#ifdef __cplusplus
}
#endif
#endif
