/* Opening an asset: every rule of formats/SPEC.md section 5, in place, without allocating. Hostile bytes are the normal case
   here: see open.h. The chunks of the surrogate energy are in asset_energy.c, those of the shape in asset_shape.c.

   On a big-endian machine format_major reads as 256 and open answers PLIANT_ERROR_VERSION: assets are used in place, so a
   byte-swapped one would have to be converted offline. */
#include "open.h"

/* ---------------------------------------------------------------------------------------- header and chunk table ---- */

static pliant_result check_header(pliant_open_context* context)
{
    static const uint8_t identifier[12] = PLIANT_FORMAT_IDENTIFIER;
    pliant_format_header* h = &context->header;
    memcpy(h, context->blob, sizeof *h);
    if (memcmp(h->identifier, identifier, sizeof identifier) != 0) return PLIANT_ERROR_NOT_PLIANT;  /* R02 */
    if (h->format_major != PLIANT_FORMAT_MAJOR) return PLIANT_ERROR_VERSION;                        /* R03 */
    if (h->file_size != context->blob_size) return PLIANT_ERROR_TRUNCATED;                          /* R04 */
    if (h->chunk_count < 1 || h->chunk_count > PLIANT_FORMAT_MAX_CHUNKS) return PLIANT_ERROR_LIMIT; /* R05, the rest too */
    if (h->vertex_count < 1 || h->vertex_count > PLIANT_FORMAT_MAX_VERTICES) return PLIANT_ERROR_LIMIT;
    if (h->triangle_count < 1 || h->triangle_count > PLIANT_FORMAT_MAX_TRIANGLES) return PLIANT_ERROR_LIMIT;
    if (h->dimension < 1 || h->dimension > PLIANT_FORMAT_MAX_DIMENSION) return PLIANT_ERROR_LIMIT;
    /* One more with LAYR, of which nothing is known yet: see check_pose_count. */
    if (h->pose_count < 2 || h->pose_count > PLIANT_FORMAT_MAX_LAYERS + 1) return PLIANT_ERROR_LIMIT;
    if (h->reserved != 0) return PLIANT_ERROR_LAYOUT;                 /* R14 */
    if (!pliant_all_finite(h->origin, 3)) return PLIANT_ERROR_NUMBER; /* R10 */
    context->dimension = pliant_pad_lanes(h->dimension);
    return PLIANT_OK;
}

static int is_known_tag(uint32_t tag)
{
    switch (tag) {
    case PLIANT_CHUNK_SOLVER:
    case PLIANT_CHUNK_ELEMENTS:
    case PLIANT_CHUNK_QUARTIC:
    case PLIANT_CHUNK_LAYERS:
    case PLIANT_CHUNK_PREDICTOR:
    case PLIANT_CHUNK_LOAD:
    case PLIANT_CHUNK_REST:
    case PLIANT_CHUNK_TRIANGLES:
    case PLIANT_CHUNK_VERTICES:
    case PLIANT_CHUNK_SMOOTHING:
    case PLIANT_CHUNK_MORPH_RANGES:
    case PLIANT_CHUNK_SCENE:
    case PLIANT_CHUNK_POLYGONS:
    case PLIANT_CHUNK_NAMES:
    case PLIANT_CHUNK_ANSWERS:
    case PLIANT_CHUNK_CERTIFICATE:
    case PLIANT_CHUNK_BASIS:
    case PLIANT_CHUNK_COMPACT:
    case PLIANT_CHUNK_FACTORED:
    case PLIANT_CHUNK_BOUNDS: return 1;
    default: return 0;
    }
}

/* R06, R07, and R14 of the table. */
static pliant_result check_chunk_table(pliant_open_context* context)
{
    const uint32_t count = context->header.chunk_count;
    uint64_t end;
    if (!pliant_fits(sizeof(pliant_format_header), count, sizeof(pliant_format_chunk), context->blob_size, &end))
        return PLIANT_ERROR_LAYOUT;
    context->chunks = (const pliant_format_chunk*)(const void*)(context->blob + sizeof(pliant_format_header));
    for (uint32_t i = 0; i < count; ++i) {
        const pliant_format_chunk* chunk = &context->chunks[i];
        const uint32_t alignment
            = chunk->tag == PLIANT_CHUNK_BASIS ? PLIANT_FORMAT_BASIS_ALIGNMENT : PLIANT_FORMAT_CHUNK_ALIGNMENT;
        if (chunk->offset % alignment != 0 || chunk->offset < end) return PLIANT_ERROR_LAYOUT;
        if (!pliant_fits(chunk->offset, chunk->size, 1, context->blob_size, &end)) return PLIANT_ERROR_LAYOUT;
        if (pliant_open_search(context->chunks, i, chunk->tag)) return PLIANT_ERROR_LAYOUT;
        if (chunk->reserved != 0 || (chunk->flags & ~PLIANT_CHUNK_FLAG_REQUIRED) != 0) return PLIANT_ERROR_LAYOUT;
    }
    for (uint32_t i = 0; i < count; ++i)
        if (!is_known_tag(context->chunks[i].tag) && (context->chunks[i].flags & PLIANT_CHUNK_FLAG_REQUIRED))
            return PLIANT_ERROR_VERSION;
    return PLIANT_OK;
}

/* R05 of the poses of averages. */
static pliant_result check_pose_count(const pliant_open_context* context)
{
    if (pliant_open_find(context, PLIANT_CHUNK_LAYERS)) return PLIANT_OK;
    return context->header.pose_count <= PLIANT_FORMAT_MAX_POSES ? PLIANT_OK : PLIANT_ERROR_LIMIT;
}

static pliant_result check_presence(const pliant_open_context* context)
{
    static const uint32_t required[] = { PLIANT_CHUNK_SOLVER, PLIANT_CHUNK_TRIANGLES, PLIANT_CHUNK_NAMES,
                                         PLIANT_CHUNK_ANSWERS, PLIANT_CHUNK_CERTIFICATE };
    for (size_t i = 0; i < sizeof required / sizeof *required; ++i)
        if (!pliant_open_find(context, required[i])) return PLIANT_ERROR_LAYOUT;
    /* One surrogate energy and one basis, and not two; BASF has the rest positions in it. */
    if (!pliant_open_find(context, PLIANT_CHUNK_ELEMENTS) == !pliant_open_find(context, PLIANT_CHUNK_QUARTIC))
        return PLIANT_ERROR_LAYOUT;
    const int has_rest = pliant_open_find(context, PLIANT_CHUNK_REST) != NULL;
    const int is_single = pliant_open_find(context, PLIANT_CHUNK_BASIS) != NULL;
    const int is_compact = pliant_open_find(context, PLIANT_CHUNK_COMPACT) != NULL;
    const int is_factored = pliant_open_find(context, PLIANT_CHUNK_FACTORED) != NULL;
    return is_single + is_compact + is_factored == 1 && has_rest == !is_factored ? PLIANT_OK : PLIANT_ERROR_LAYOUT;
}

/* ------------------------------------------------------------------------------------------------------ checksums ---- */

/* One step of CRC-32 for each byte value, made on the caller's stack: 1 KiB, and no table to be initialised by anyone. */
static void make_crc32_table(uint32_t table[256])
{
    for (uint32_t i = 0; i < 256; ++i) {
        uint32_t value = i;
        for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ (0xEDB88320u & (0u - (value & 1u)));
        table[i] = value;
    }
}

static uint32_t update_crc32(const uint32_t table[256], uint32_t crc, const unsigned char* bytes, uint64_t size)
{
    for (uint64_t i = 0; i < size; ++i) crc = (crc >> 8) ^ table[(crc ^ bytes[i]) & 0xFFu];
    return crc;
}

/* R08, R12 */
static pliant_result check_checksums(const pliant_open_context* context)
{
    uint32_t table[256];
    pliant_format_header header = context->header;
    const uint64_t table_size = (uint64_t)header.chunk_count * sizeof(pliant_format_chunk);
    make_crc32_table(table);
    header.header_crc32 = 0;
    uint32_t crc = update_crc32(table, 0xFFFFFFFFu, (const unsigned char*)&header, sizeof header);
    crc = update_crc32(table, crc, context->blob + sizeof header, table_size);
    if ((crc ^ 0xFFFFFFFFu) != context->header.header_crc32) return PLIANT_ERROR_CHECKSUM;
    for (uint32_t i = 0; i < context->header.chunk_count; ++i) {
        const pliant_format_chunk* chunk = &context->chunks[i];
        crc = update_crc32(table, 0xFFFFFFFFu, context->blob + chunk->offset, chunk->size);
        if ((crc ^ 0xFFFFFFFFu) != chunk->crc32) return PLIANT_ERROR_CHECKSUM;
    }
    return PLIANT_OK;
}

/* --------------------------------------------------------------------------------------------------- single chunks ---- */

static pliant_result open_solver(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_SOLVER);
    const unsigned char* start = context->blob + chunk->offset;
    const uint64_t vectors = 1 + (uint64_t)context->header.dimension + context->header.pose_count;
    pliant_format_solver head;
    uint64_t end;
    if (!pliant_fits(sizeof head, vectors, context->dimension * sizeof(float), chunk->size, &end) || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    memcpy(&head, start, sizeof head);
    if (!pliant_is_zero(head.reserved, sizeof head.reserved)) return PLIANT_ERROR_LAYOUT;
    if (!pliant_is_finite(head.energy_scale) || !(head.energy_scale > 0.0f)) return PLIANT_ERROR_NUMBER;
    asset->energy_scale = head.energy_scale;
    asset->mean = (const float*)(const void*)(start + sizeof head);
    asset->whitening = asset->mean + context->dimension;
    asset->pose_coordinates = asset->whitening + context->header.dimension * context->dimension;
    return pliant_all_finite(asset->mean, vectors * context->dimension) ? PLIANT_OK : PLIANT_ERROR_NUMBER;
}

static int all_below(const uint32_t* indices, uint64_t count, uint32_t limit)
{
    uint32_t bad = 0;
    for (uint64_t i = 0; i < count; ++i) bad |= (uint32_t)(indices[i] >= limit);
    return bad == 0;
}

/* Vertices of a solid: those of its boundary first. Must be opened before what names vertices. */
static pliant_result open_vertices(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_VERTICES);
    const uint32_t n = context->header.vertex_count;
    uint64_t end;
    asset->boundary_vertex_count = n;
    if (!chunk) return PLIANT_OK;
    const pliant_result result = pliant_open_count(context, chunk, n, &asset->boundary_vertex_count);
    if (result != PLIANT_OK) return result;
    if (!pliant_fits(sizeof(pliant_format_count), n, sizeof(uint32_t), chunk->size, &end) || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    asset->source_vertices = (const uint32_t*)(const void*)(context->blob + chunk->offset + sizeof(pliant_format_count));
    return all_below(asset->source_vertices, n, n) ? PLIANT_OK : PLIANT_ERROR_INDEX;
}

static pliant_result open_triangles(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_TRIANGLES);
    const uint64_t corners = 3 * (uint64_t)context->header.triangle_count;
    uint64_t end;
    if (!pliant_fits(0, corners, sizeof(uint32_t), chunk->size, &end) || end != chunk->size) return PLIANT_ERROR_LAYOUT;
    asset->triangles = (const uint32_t*)(const void*)(context->blob + chunk->offset);
    return all_below(asset->triangles, corners, asset->boundary_vertex_count) ? PLIANT_OK : PLIANT_ERROR_INDEX;
}

static pliant_result open_smoothing(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_SMOOTHING);
    const uint32_t n = context->header.vertex_count;
    uint64_t end;
    if (!chunk) return PLIANT_OK;
    if (!pliant_fits(0, n, sizeof(uint32_t), chunk->size, &end) || end != chunk->size) return PLIANT_ERROR_LAYOUT;
    asset->smoothing_groups = (const uint32_t*)(const void*)(context->blob + chunk->offset);
    return all_below(asset->smoothing_groups, n, n) ? PLIANT_OK : PLIANT_ERROR_INDEX;
}

static pliant_result check_polygons(const pliant_open_context* context, const pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_POLYGONS);
    uint64_t sizes_end, end;
    if (!chunk) return PLIANT_OK;
    if (chunk->size < 2 * sizeof(uint32_t)) return PLIANT_ERROR_LAYOUT;
    const uint32_t* words = (const uint32_t*)(const void*)(context->blob + chunk->offset);
    if (!pliant_fits(2 * sizeof(uint32_t), words[0], sizeof(uint32_t), chunk->size, &sizes_end)) return PLIANT_ERROR_LAYOUT;
    if (!pliant_fits(sizes_end, words[1], sizeof(uint32_t), chunk->size, &end) || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    uint64_t sum = 0; /* of fewer than 2^32 numbers below 2^32 */
    for (uint32_t i = 0; i < words[0]; ++i) {
        if (words[2 + (size_t)i] < 3) return PLIANT_ERROR_INDEX;
        sum += words[2 + (size_t)i];
    }
    if (sum != words[1]) return PLIANT_ERROR_INDEX;
    return all_below(words + 2 + (size_t)words[0], words[1], asset->boundary_vertex_count) ? PLIANT_OK : PLIANT_ERROR_INDEX;
}

static pliant_result check_names(const pliant_open_context* context)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_NAMES);
    const unsigned char* names = context->blob + chunk->offset;
    uint64_t ends = 0;
    for (uint64_t i = 0; i < chunk->size; ++i) ends += names[i] == 0;
    if (ends != context->header.pose_count || names[chunk->size - 1] != 0) return PLIANT_ERROR_INDEX;
    return PLIANT_OK;
}

/* R13: those of an average, or (1, v). */
static int are_answer_weights(const float* weights, uint32_t count, uint32_t has_layers)
{
    double sum = 0.0;
    if (has_layers) return weights[0] == 1.0f;
    for (uint32_t k = 0; k < count; ++k) {
        if (weights[k] < 0.0f) return 0;
        sum += (double)weights[k];
    }
    return sum >= 1.0 - 1e-3 && sum <= 1.0 + 1e-3;
}

static pliant_result check_answers(const pliant_open_context* context, const pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_ANSWERS);
    const uint32_t m = context->header.pose_count;
    const uint64_t width = (uint64_t)m + context->header.dimension;
    uint32_t count;
    uint64_t end;
    const pliant_result result = pliant_open_count(context, chunk, PLIANT_FORMAT_MAX_ANSWERS, &count);
    if (result != PLIANT_OK) return result;
    if (!pliant_fits(sizeof(pliant_format_count), count, width * sizeof(float), chunk->size, &end) || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    const float* answer = (const float*)(const void*)(context->blob + chunk->offset + sizeof(pliant_format_count));
    if (!pliant_all_finite(answer, count * width)) return PLIANT_ERROR_NUMBER;
    for (uint32_t i = 0; i < count; ++i, answer += width)
        if (!are_answer_weights(answer, m, asset->has_layers)) return PLIANT_ERROR_NUMBER;
    return PLIANT_OK;
}

/* ------------------------------------------------------------------------------------------------------------ API ---- */

static pliant_result open_checked(pliant_open_context* context, pliant_asset* asset, uint32_t flags)
{
    pliant_result result = check_header(context);
    if (result == PLIANT_OK) result = check_chunk_table(context);
    if (result == PLIANT_OK) result = check_pose_count(context);
    if (result == PLIANT_OK) result = check_presence(context);
    if (result == PLIANT_OK && (flags & PLIANT_OPEN_VERIFY_CHECKSUMS)) result = check_checksums(context);
    if (result == PLIANT_OK) result = open_solver(context, asset);
    if (result == PLIANT_OK) result = pliant_open_energy(context, asset);
    if (result == PLIANT_OK) result = pliant_open_shape(context, asset);
    if (result == PLIANT_OK) result = open_vertices(context, asset);
    if (result == PLIANT_OK) result = open_triangles(context, asset);
    if (result == PLIANT_OK) result = open_smoothing(context, asset);
    if (result == PLIANT_OK) result = check_polygons(context, asset);
    if (result == PLIANT_OK) result = check_names(context);
    if (result == PLIANT_OK) result = check_answers(context, asset);
    if (result == PLIANT_OK) result = pliant_open_morph_ranges(context, asset);
    return result;
}

pliant_result pliant_asset_open(pliant_asset* out, const void* blob, size_t blob_size, uint32_t flags)
{
    pliant_asset asset;
    pliant_open_context context;
    if (!out) return PLIANT_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    if (!blob || (flags & ~PLIANT_OPEN_VERIFY_CHECKSUMS) != 0) return PLIANT_ERROR_ARGUMENT;
    if ((uintptr_t)blob % PLIANT_FORMAT_BLOB_ALIGNMENT != 0) return PLIANT_ERROR_ALIGNMENT; /* R01 */
    if (blob_size < sizeof(pliant_format_header)) return PLIANT_ERROR_TRUNCATED;            /* R01 */

    memset(&asset, 0, sizeof asset);
    memset(&context, 0, sizeof context);
    context.blob = (const unsigned char*)blob;
    context.blob_size = blob_size;
    const pliant_result result = open_checked(&context, &asset, flags);
    if (result != PLIANT_OK) return result;

    asset.vertex_count = context.header.vertex_count;
    asset.triangle_count = context.header.triangle_count;
    asset.dimension = context.header.dimension;
    asset.pose_count = context.header.pose_count;
    asset.weight_count = asset.pose_count - asset.has_layers;
    memcpy(asset.origin, context.header.origin, sizeof asset.origin);
    asset.kernels = pliant_kernels_choose();
    asset.blob = context.blob;
    asset.blob_size = context.blob_size;
    asset.padded_dimension = (uint32_t)context.dimension;
    *out = asset;
    return PLIANT_OK;
}

const void* pliant_asset_chunk(const pliant_asset* asset, uint32_t tag, size_t* size)
{
    if (size) *size = 0;
    if (!asset || !asset->blob) return NULL;
    pliant_format_header header;
    memcpy(&header, asset->blob, sizeof header);
    const pliant_format_chunk* chunks = (const pliant_format_chunk*)(const void*)(asset->blob + sizeof header);
    const pliant_format_chunk* chunk = pliant_open_search(chunks, header.chunk_count, tag);
    if (!chunk) return NULL;
    if (size) *size = (size_t)chunk->size;
    return asset->blob + chunk->offset;
}

const char* pliant_asset_pose_name(const pliant_asset* asset, uint32_t pose)
{
    const char* name = (const char*)pliant_asset_chunk(asset, PLIANT_CHUNK_NAMES, NULL);
    if (!name || pose >= asset->pose_count) return NULL;
    for (uint32_t k = 0; k < pose; ++k) name += strlen(name) + 1; /* check_names counted the zero bytes */
    return name;
}

pliant_result pliant_asset_weight(const pliant_asset* asset, uint32_t index, pliant_weight* out)
{
    if (!asset || !asset->blob || !out || index >= asset->weight_count) return PLIANT_ERROR_ARGUMENT;
    out->name = pliant_asset_pose_name(asset, index + asset->has_layers); /* pose 0 of layers has no weight */
    out->low = asset->layers ? asset->layers[index].low : 0.0f;
    out->high = asset->layers ? asset->layers[index].high : 1.0f;
    out->initial = asset->layers ? asset->layers[index].initial : 1.0f / (float)asset->weight_count;
    return PLIANT_OK;
}

const float* pliant_asset_pose_coordinates(const pliant_asset* asset, uint32_t pose)
{
    if (!asset || !asset->pose_coordinates || pose >= asset->pose_count) return NULL;
    return asset->pose_coordinates + (size_t)pose * asset->padded_dimension;
}

uint32_t pliant_version(void) { return PLIANT_VERSION_MAJOR * 10000u + PLIANT_VERSION_MINOR * 100u + PLIANT_VERSION_PATCH; }

const char* pliant_result_text(pliant_result result)
{
    switch (result) {
    case PLIANT_OK: return "success";
    case PLIANT_ERROR_ARGUMENT:
        return "bad argument: a null pointer, an index or a count out of range, an unknown flag, or a desc without defaults";
    case PLIANT_ERROR_MEMORY_SIZE: return "the memory given is smaller than the _memory function says";
    case PLIANT_ERROR_ALIGNMENT: return "the asset does not lie at an address that is a multiple of 16";
    case PLIANT_ERROR_ABSENT: return "the asset does not hold what was asked for";
    case PLIANT_ERROR_TRUNCATED: return "the asset is not as long as it says: cut off, or more than one file";
    case PLIANT_ERROR_NOT_PLIANT: return "not a .pliant asset, or damaged by a transfer in text mode";
    case PLIANT_ERROR_VERSION: return "the asset needs another version of the runtime";
    case PLIANT_ERROR_LIMIT: return "a count in the asset is outside its range";
    case PLIANT_ERROR_LAYOUT: return "a chunk of the asset is missing, misplaced or of the wrong size";
    case PLIANT_ERROR_NUMBER: return "a number in the asset is not finite or outside its range";
    case PLIANT_ERROR_INDEX: return "the topology or the names of the asset do not add up";
    case PLIANT_ERROR_CHECKSUM: return "a checksum of the asset does not match: it was damaged";
    case PLIANT_ERROR_WEIGHT_NOT_FINITE: return "a weight is infinite or not a number";
    case PLIANT_ERROR_WEIGHT_NEGATIVE: return "a weight is negative";
    case PLIANT_ERROR_WEIGHT_SUM: return "all weights are zero";
    }
    return "unknown result code";
}

/* ---------------------------------------------------------------------------------------------------- fields ---- */

size_t pliant_asset_size(void) { return sizeof(pliant_asset); }

uint32_t pliant_asset_get_vertex_count(const pliant_asset* asset) { return asset ? asset->vertex_count : 0; }
uint32_t pliant_asset_get_boundary_vertex_count(const pliant_asset* asset)
{
    return asset ? asset->boundary_vertex_count : 0;
}
uint32_t pliant_asset_get_triangle_count(const pliant_asset* asset) { return asset ? asset->triangle_count : 0; }
uint32_t pliant_asset_get_dimension(const pliant_asset* asset) { return asset ? asset->dimension : 0; }
uint32_t pliant_asset_get_pose_count(const pliant_asset* asset) { return asset ? asset->pose_count : 0; }
uint32_t pliant_asset_get_weight_count(const pliant_asset* asset) { return asset ? asset->weight_count : 0; }
uint32_t pliant_asset_get_has_layers(const pliant_asset* asset) { return asset ? asset->has_layers : 0; }
const float* pliant_asset_get_origin(const pliant_asset* asset) { return asset ? asset->origin : NULL; }
const uint32_t* pliant_asset_get_triangles(const pliant_asset* asset) { return asset ? asset->triangles : NULL; }
const uint32_t* pliant_asset_get_source_vertices(const pliant_asset* asset) { return asset ? asset->source_vertices : NULL; }
const uint32_t* pliant_asset_get_smoothing_groups(const pliant_asset* asset)
{
    return asset ? asset->smoothing_groups : NULL;
}
