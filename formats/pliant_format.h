/* The structures of a .pliant asset, as defined by SPEC.md (format 1.5). C99 and C++11. The runtime reads them, the baker
   writes them. Plain little-endian data without pointers and padding. */
#ifndef PLIANT_FORMAT_H
#define PLIANT_FORMAT_H

#include <stdint.h>

#define PLIANT_FORMAT_MAJOR 1
#define PLIANT_FORMAT_MINOR 5          /* the newest; a file states the oldest that supports its contents */
#define PLIANT_FORMAT_MINOR_LOAD 1     /* first version with LOAD */
#define PLIANT_FORMAT_MINOR_SOLID 2    /* first version with QUAR, VERT and elements for tetrahedra */
#define PLIANT_FORMAT_MINOR_PARTS 3    /* first version with BASC, BNDS, SMTH, GLTF, MRNG and ties between parts */
#define PLIANT_FORMAT_MINOR_FACTORED 4 /* first version with BASF */
#define PLIANT_FORMAT_MINOR_LAYERS 5   /* first version with LAYR */

/* "«PLIANT»", then CR LF EOF LF: a transfer in text mode breaks it visibly. */
#define PLIANT_FORMAT_IDENTIFIER                                               \
    {                                                                          \
        0xAB, 0x50, 0x4C, 0x49, 0x41, 0x4E, 0x54, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A \
    }

/* Chunk tags: four letters, the first one in the lowest byte. */
#define PLIANT_FORMAT_TAG(a, b, c, d) ((uint32_t)(a) | ((uint32_t)(b) << 8) | ((uint32_t)(c) << 16) | ((uint32_t)(d) << 24))
#define PLIANT_CHUNK_SOLVER PLIANT_FORMAT_TAG('S', 'O', 'L', 'V')
#define PLIANT_CHUNK_ELEMENTS PLIANT_FORMAT_TAG('E', 'L', 'E', 'M')
#define PLIANT_CHUNK_QUARTIC PLIANT_FORMAT_TAG('Q', 'U', 'A', 'R')
#define PLIANT_CHUNK_LAYERS PLIANT_FORMAT_TAG('L', 'A', 'Y', 'R')
#define PLIANT_CHUNK_PREDICTOR PLIANT_FORMAT_TAG('P', 'R', 'E', 'D')
#define PLIANT_CHUNK_LOAD PLIANT_FORMAT_TAG('L', 'O', 'A', 'D')
#define PLIANT_CHUNK_REST PLIANT_FORMAT_TAG('R', 'E', 'S', 'T')
#define PLIANT_CHUNK_TRIANGLES PLIANT_FORMAT_TAG('T', 'R', 'I', 'S')
#define PLIANT_CHUNK_MORPH_RANGES PLIANT_FORMAT_TAG('M', 'R', 'N', 'G')
#define PLIANT_CHUNK_VERTICES PLIANT_FORMAT_TAG('V', 'E', 'R', 'T')
#define PLIANT_CHUNK_SMOOTHING PLIANT_FORMAT_TAG('S', 'M', 'T', 'H')
#define PLIANT_CHUNK_POLYGONS PLIANT_FORMAT_TAG('P', 'O', 'L', 'Y')
#define PLIANT_CHUNK_NAMES PLIANT_FORMAT_TAG('N', 'A', 'M', 'E')
#define PLIANT_CHUNK_ANSWERS PLIANT_FORMAT_TAG('A', 'N', 'S', 'W')
#define PLIANT_CHUNK_CERTIFICATE PLIANT_FORMAT_TAG('C', 'E', 'R', 'T')
#define PLIANT_CHUNK_SCENE PLIANT_FORMAT_TAG('G', 'L', 'T', 'F')
#define PLIANT_CHUNK_BASIS PLIANT_FORMAT_TAG('B', 'A', 'S', 'I')
#define PLIANT_CHUNK_COMPACT PLIANT_FORMAT_TAG('B', 'A', 'S', 'C')
#define PLIANT_CHUNK_FACTORED PLIANT_FORMAT_TAG('B', 'A', 'S', 'F')
#define PLIANT_CHUNK_BOUNDS PLIANT_FORMAT_TAG('B', 'N', 'D', 'S')

#define PLIANT_CHUNK_FLAG_REQUIRED 1u

/* Limits (SPEC.md, sections 3 and 4). A reader checks them before it multiplies counts. */
#define PLIANT_FORMAT_MAX_VERTICES (1u << 26)
#define PLIANT_FORMAT_MAX_TRIANGLES (1u << 27)
#define PLIANT_FORMAT_MAX_DIMENSION 256u
#define PLIANT_FORMAT_MAX_QUARTIC_DIMENSION 64u /* with QUAR */
#define PLIANT_FORMAT_MAX_POSES 64u
#define PLIANT_FORMAT_MAX_LAYERS 64u /* with LAYR: beside the rest shape */
#define PLIANT_FORMAT_MAX_CHUNKS 64u
#define PLIANT_FORMAT_MAX_BATCHES 64u
#define PLIANT_FORMAT_MAX_ELEMENTS (1u << 22)
#define PLIANT_FORMAT_MAX_VALENCE 32u
#define PLIANT_FORMAT_MAX_CENTRES 4096u
#define PLIANT_FORMAT_MAX_ANSWERS 64u
#define PLIANT_FORMAT_MAX_WIDTH 24u /* bits of a field of BASC and BASF: single precision holds them exactly */
#define PLIANT_FORMAT_MAX_SHIFT 15u /* shift of a column's bases in BASC */
#define PLIANT_FORMAT_MAX_CLUSTERS 256u
#define PLIANT_FORMAT_MAX_BLOCK_VERTICES 65536u /* vertices of a block of BASF */
#define PLIANT_FORMAT_MAX_PRODUCT_COLUMNS 192u  /* columns of the left factor of a tile of BASF */

#define PLIANT_FORMAT_BLOB_ALIGNMENT 16u
#define PLIANT_FORMAT_CHUNK_ALIGNMENT 64u
#define PLIANT_FORMAT_BASIS_ALIGNMENT 4096u
#define PLIANT_FORMAT_LANES 16u         /* element lanes and vector padding, in floats */
#define PLIANT_FORMAT_TILE_VERTICES 16u /* vertices of a REST or BASI tile */
#define PLIANT_FORMAT_TILE_FLOATS 48u
#define PLIANT_FORMAT_COMPACT_PARTS 4u     /* number of REST tiles in a tile of BASC */
#define PLIANT_FORMAT_COMPACT_VERTICES 64u /* vertices of a tile of BASC */
#define PLIANT_FORMAT_AFFINE_ROWS 12u      /* rows of a right factor of BASF before those of its columns */
#define PLIANT_FORMAT_ROW_GROUP 8u         /* the rows of a right factor are padded to a multiple of this */
#define PLIANT_FORMAT_QUARTIC_LANES 8u     /* rows of QUAR start and end at multiples of this */

typedef struct pliant_format_header {
    uint8_t identifier[12];
    uint16_t format_major;
    uint16_t format_minor;
    uint64_t file_size;
    uint32_t chunk_count;
    uint32_t header_crc32;
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t dimension;
    uint32_t pose_count;
    float origin[3];
    uint32_t reserved;
} pliant_format_header; /* 64 bytes */

typedef struct pliant_format_chunk {
    uint32_t tag;
    uint32_t flags;
    uint64_t offset;
    uint64_t size;
    uint32_t crc32;
    uint32_t reserved;
} pliant_format_chunk; /* 32 bytes */

/* First 64 bytes of SOLV. */
typedef struct pliant_format_solver {
    float energy_scale;
    uint32_t reserved[15];
} pliant_format_solver;

/* First 64 bytes of ELEM, QUAR, LAYR, PRED, LOAD, VERT, ANSW and BNDS: the number of batches, floats of a table, layers,
   centres (PRED and LOAD), boundary vertices, answers and clusters. */
typedef struct pliant_format_count {
    uint32_t count;
    uint32_t reserved[15];
} pliant_format_count;

/* A layer of LAYR. */
typedef struct pliant_format_layer {
    float low, high; /* range of the weight whose blends the baker has measured */
    float initial;   /* weight to start with */
    uint32_t reserved;
} pliant_format_layer; /* 16 bytes */

/* First 64 bytes of BASC. */
typedef struct pliant_format_compact {
    uint32_t tile_count;
    float position_error; /* error that the baker was asked to keep, in units of the input */
    uint32_t reserved[14];
} pliant_format_compact;

/* A column of BASC: dimension j of q. */
typedef struct pliant_format_column {
    float scale;        /* of its numbers; multiplied by the factor of the tile */
    uint32_t shift;     /* bases are in units of 2^shift */
    float reach;        /* no vertex moves further than this per unit of q_j */
    float limit;        /* largest |q_j| for which position_error is kept */
} pliant_format_column; /* 16 bytes */

typedef struct pliant_format_tile {
    uint32_t offset; /* of its fields, in words of 4 bytes from the start of the data */
    float factor;
} pliant_format_tile; /* 8 bytes */

/* A column in a tile: u = factor scale (2^shift base[c] + field). Fields are unsigned numbers of `width` bits. */
typedef struct pliant_format_field {
    int16_t base[3]; /* of x, y and z */
    uint16_t width;
} pliant_format_field; /* 8 bytes */

/* First 64 bytes of BASF. */
typedef struct pliant_format_factored {
    uint32_t tile_count;
    float position_error;    /* as in BASC */
    uint32_t block_vertices; /* consecutive vertices that share tiles */
    uint32_t reserved[13];
} pliant_format_factored;

/* A tile of BASF: at most 64 vertices of one block. */
typedef struct pliant_format_product {
    uint32_t offset; /* of its data, in words of 4 bytes from the start of the data */
    uint16_t vertex_count;
    uint16_t column_count; /* of the left factor */
    float rest_origin[3];  /* rest = rest_origin + rest_scale * number */
    float rest_scale;      /* 0: the tile is still, rest positions are in single precision */
} pliant_format_product;   /* 24 bytes */

/* A cluster of BNDS has 1 + d of these: one for its vertices at q = 0, then one for each column. */
typedef struct pliant_format_interval {
    float centre[3];
    float radius[3];
} pliant_format_interval; /* 24 bytes */

typedef enum pliant_element_kind {
    PLIANT_ELEMENT_HINGE = 1,
    PLIANT_ELEMENT_FACE_NEO_HOOKEAN = 2,
    PLIANT_ELEMENT_FACE_STVK = 3,
    PLIANT_ELEMENT_FACE_EDGE = 4,
    PLIANT_ELEMENT_ARAP_CELL = 5,
    PLIANT_ELEMENT_TET_STVK = 6,
    PLIANT_ELEMENT_TET_MOONEY_RIVLIN = 7,
    PLIANT_ELEMENT_TIE = 8,
    PLIANT_ELEMENT_LAYERED_HINGE = 9,
    PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN = 10,
    PLIANT_ELEMENT_LAYERED_ARAP_CELL = 11
} pliant_element_kind;

typedef struct pliant_format_batch {
    uint32_t kind;
    uint32_t element_count;
    uint32_t valence;
    uint32_t is_closed;
    uint64_t rows_offset;
    uint64_t fixed_offset;
    uint64_t pose_offset;
    uint64_t changes_offset; /* of layers */
    uint32_t change_count;
    uint8_t reserved[12];
} pliant_format_batch; /* 64 bytes */

/* Where a layer changes the numbers of a batch: in 16 lanes from 16 group on. */
typedef struct pliant_format_change {
    uint32_t layer;
    uint32_t group;
} pliant_format_change; /* 8 bytes */

/* From changes_offset to the changes themselves, behind `count` records and padding. */
static inline uint64_t pliant_format_change_floats_offset(uint32_t count)
{
    return (sizeof(pliant_format_change) * (uint64_t)count + 63) & ~(uint64_t)63;
}

/* Number of arrays of a batch: R rows of differences, F fixed numbers, K numbers per pose (SPEC.md, table of kinds). All
   zero for an unknown kind. */
typedef struct pliant_format_shape {
    uint32_t row_count;
    uint32_t fixed_count;
    uint32_t pose_number_count;
} pliant_format_shape;

/* clang-format off */
static inline pliant_format_shape pliant_format_batch_shape(uint32_t kind, uint32_t valence, uint32_t is_closed)
{
    pliant_format_shape shape = { 0, 0, 0 };
    switch (kind) {
    case PLIANT_ELEMENT_HINGE: shape.row_count = 9; shape.fixed_count = 2; shape.pose_number_count = 2; break;
    case PLIANT_ELEMENT_FACE_NEO_HOOKEAN: shape.row_count = 6; shape.fixed_count = 4; shape.pose_number_count = 5; break;
    case PLIANT_ELEMENT_FACE_STVK: shape.row_count = 6; shape.fixed_count = 0; shape.pose_number_count = 9; break;
    case PLIANT_ELEMENT_FACE_EDGE: shape.row_count = 6; shape.fixed_count = 4; shape.pose_number_count = 8; break;
    case PLIANT_ELEMENT_ARAP_CELL:
        shape.row_count = 3 * valence;
        shape.pose_number_count = 4 * (valence + (is_closed ? valence : valence - 1)) + 1;
        break;
    case PLIANT_ELEMENT_TET_STVK: shape.row_count = 9; shape.pose_number_count = 27; break;
    case PLIANT_ELEMENT_TET_MOONEY_RIVLIN: shape.row_count = 9; shape.pose_number_count = 20; break;
    case PLIANT_ELEMENT_LAYERED_HINGE: shape.row_count = 9; shape.fixed_count = 2; shape.pose_number_count = 1; break;
    case PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN: shape.row_count = 6; shape.fixed_count = 9; shape.pose_number_count = 3; break;
    case PLIANT_ELEMENT_LAYERED_ARAP_CELL:
        shape.row_count = 3 * valence;
        shape.fixed_count = valence + (is_closed ? valence : valence - 1);
        shape.pose_number_count = 3 * shape.fixed_count;
        break;
    case PLIANT_ELEMENT_TIE: shape.row_count = 9; shape.pose_number_count = 4; break;
    default: break;
    }
    return shape;
}
/* clang-format on */

/* QUAR is a polynomial in x = (1, z), N = d+1 numbers. The pairs (a, b), a <= b < N, are numbered by a, then by b. Returns
   the number of the pair (a, a); with a = N the number of all pairs. */
static inline uint32_t pliant_format_quartic_pair(uint32_t dimension, uint32_t a)
{
    return a * (dimension + 1) - a * (a - 1) / 2;
}

/* End of the rows (i, j) of a table: the number of pairs, rounded up. */
static inline uint32_t pliant_format_quartic_row_end(uint32_t dimension)
{
    const uint32_t pairs = pliant_format_quartic_pair(dimension, dimension + 1);
    return (pairs + PLIANT_FORMAT_QUARTIC_LANES - 1) / PLIANT_FORMAT_QUARTIC_LANES * PLIANT_FORMAT_QUARTIC_LANES;
}

/* Start of the rows (0, j) .. (j, j): the number of the pair (j, j), rounded down. */
static inline uint32_t pliant_format_quartic_row_start(uint32_t dimension, uint32_t j)
{
    return pliant_format_quartic_pair(dimension, j) / PLIANT_FORMAT_QUARTIC_LANES * PLIANT_FORMAT_QUARTIC_LANES;
}

/* T, the number of floats in the table of one pose. The distance of tables is T rounded up to a multiple of 16. */
static inline uint64_t pliant_format_quartic_floats(uint32_t dimension)
{
    uint64_t sum = 0;
    for (uint32_t j = 0; j <= dimension; ++j)
        sum += (uint64_t)(j + 1)
            * (pliant_format_quartic_row_end(dimension) - pliant_format_quartic_row_start(dimension, j));
    return sum;
}

/* Offsets from the start of BASC: its tiles, its field records (tile_count x dimension) and its data. */
static inline uint64_t pliant_format_compact_tiles(uint32_t dimension)
{
    const uint64_t columns = dimension * (uint64_t)sizeof(pliant_format_column);
    return sizeof(pliant_format_compact)
        + (columns + PLIANT_FORMAT_CHUNK_ALIGNMENT - 1) / PLIANT_FORMAT_CHUNK_ALIGNMENT * PLIANT_FORMAT_CHUNK_ALIGNMENT;
}

static inline uint64_t pliant_format_compact_fields(uint32_t dimension, uint32_t tile_count)
{
    return pliant_format_compact_tiles(dimension) + (uint64_t)tile_count * sizeof(pliant_format_tile);
}

static inline uint64_t pliant_format_compact_data(uint32_t dimension, uint32_t tile_count)
{
    const uint64_t end = pliant_format_compact_fields(dimension, tile_count)
        + (uint64_t)tile_count * dimension * sizeof(pliant_format_field);
    return (end + PLIANT_FORMAT_CHUNK_ALIGNMENT - 1) / PLIANT_FORMAT_CHUNK_ALIGNMENT * PLIANT_FORMAT_CHUNK_ALIGNMENT;
}

/* Size of one part of a tile in words of 4 bytes: 6 words per 4 bits, rounded up. `bits` is the sum over the columns of bits
   per lane. */
static inline uint32_t pliant_format_compact_part(uint32_t bits) { return (bits + 3) / 4 * 6; }

/* Offsets from the start of BASF: its blocks (the first tile of each, and the number of tiles behind the last), its tiles
   and its data. `block_vertices` is not 0. */
static inline uint64_t pliant_format_factored_blocks(uint32_t dimension) { return pliant_format_compact_tiles(dimension); }

static inline uint32_t pliant_format_block_count(uint32_t vertex_count, uint32_t block_vertices)
{
    return (vertex_count - 1) / block_vertices + 1;
}

static inline uint64_t pliant_format_factored_tiles(uint32_t dimension, uint32_t block_count)
{
    const uint64_t end = pliant_format_factored_blocks(dimension) + (block_count + (uint64_t)1) * sizeof(uint32_t);
    return (end + PLIANT_FORMAT_CHUNK_ALIGNMENT - 1) / PLIANT_FORMAT_CHUNK_ALIGNMENT * PLIANT_FORMAT_CHUNK_ALIGNMENT;
}

static inline uint64_t pliant_format_factored_data(uint32_t dimension, uint32_t block_count, uint32_t tile_count)
{
    const uint64_t end
        = pliant_format_factored_tiles(dimension, block_count) + tile_count * (uint64_t)sizeof(pliant_format_product);
    return (end + PLIANT_FORMAT_CHUNK_ALIGNMENT - 1) / PLIANT_FORMAT_CHUNK_ALIGNMENT * PLIANT_FORMAT_CHUNK_ALIGNMENT;
}

/* Parts of 16 vertices in a tile of BASF. */
static inline uint32_t pliant_format_product_parts(const pliant_format_product* tile)
{
    return (tile->vertex_count + PLIANT_FORMAT_TILE_VERTICES - 1) / PLIANT_FORMAT_TILE_VERTICES;
}

/* True if a tile of BASF is still: rest_scale is 0. By its bytes, since this decides where the tile's parts are: a thread
   that takes denormal numbers for 0 must find them where another one checked them. */
static inline int pliant_format_product_is_still(const pliant_format_product* tile)
{
    const unsigned char* bytes = (const unsigned char*)&tile->rest_scale; /* the last one has the sign */
    return (bytes[0] | bytes[1] | bytes[2] | (bytes[3] & 0x7F)) == 0;
}

/* Rows of the right factor of a tile of BASF, padded; 0 for a still one. */
static inline uint32_t pliant_format_product_rows(const pliant_format_product* tile)
{
    const uint32_t rows = PLIANT_FORMAT_AFFINE_ROWS + tile->column_count;
    if (pliant_format_product_is_still(tile)) return 0;
    return (rows + PLIANT_FORMAT_ROW_GROUP - 1) / PLIANT_FORMAT_ROW_GROUP * PLIANT_FORMAT_ROW_GROUP;
}

/* The bases of a column of BASF are in units of 2^shift. */
static inline uint32_t pliant_format_product_shift(uint32_t width) { return width > 15 ? width - 15 : 0; }

/* Words of 4 bytes from the start of a tile of BASF to its fields, and from there to the left factor. */
static inline uint32_t pliant_format_product_fields(const pliant_format_product* tile, uint32_t dimension)
{
    const uint32_t rows = pliant_format_product_rows(tile);
    return pliant_format_product_parts(tile) * (PLIANT_FORMAT_TILE_VERTICES / 2) + rows + rows / 2 * dimension;
}

static inline uint32_t pliant_format_product_left(const pliant_format_product* tile)
{
    const uint32_t rest = pliant_format_product_is_still(tile) ? PLIANT_FORMAT_TILE_FLOATS : PLIANT_FORMAT_TILE_FLOATS / 2;
    return 2u * tile->column_count + pliant_format_product_parts(tile) * rest;
}

#endif
