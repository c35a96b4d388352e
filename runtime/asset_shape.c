/* Opening what positions are rebuilt from: REST, the basis in one of its two forms, and the clusters of bounding boxes. */
#include "open.h"

static uint64_t rest_tiles(const pliant_open_context* context)
{
    return ((uint64_t)context->header.vertex_count + PLIANT_FORMAT_TILE_VERTICES - 1) / PLIANT_FORMAT_TILE_VERTICES;
}

/* BASI is read by reconstruction alone, as REST is: their numbers move vertices and no pointers, so only
   sizes are checked. */
static pliant_result open_floats(const pliant_open_context* context, const pliant_format_chunk* basis, pliant_asset* asset)
{
    const uint64_t tile_size = PLIANT_FORMAT_TILE_FLOATS * sizeof(float);
    uint64_t end;
    if (!pliant_fits(0, rest_tiles(context), tile_size * context->header.dimension, basis->size, &end) || end != basis->size)
        return PLIANT_ERROR_LAYOUT;
    asset->basis = (const float*)(const void*)(context->blob + basis->offset);
    return PLIANT_OK;
}

static int is_size(float value) { return pliant_is_finite(value) && value >= 0.0f; }

/* R05 of widths, R14 of the padding, R19. */
static pliant_result check_columns(const pliant_format_column* columns, uint32_t dimension)
{
    const unsigned char* end = (const unsigned char*)(columns + dimension);
    for (uint32_t j = 0; j < dimension; ++j) {
        if (columns[j].shift > PLIANT_FORMAT_MAX_SHIFT) return PLIANT_ERROR_LAYOUT;
        if (!is_size(columns[j].scale) || !is_size(columns[j].reach) || !is_size(columns[j].limit))
            return PLIANT_ERROR_NUMBER;
    }
    const uint64_t padding
        = pliant_format_compact_tiles(dimension) - sizeof(pliant_format_compact) - dimension * sizeof *columns;
    return pliant_is_zero(end, (size_t)padding) ? PLIANT_OK : PLIANT_ERROR_LAYOUT;
}

/* R18: tiles follow each other and end with the chunk, so that the runtime may follow their offsets and widths. */
static pliant_result check_tiles(const pliant_open_context* context, const pliant_asset* asset, uint32_t tile_count,
                                 uint64_t data_size)
{
    const uint32_t dimension = context->header.dimension;
    uint64_t words = 0; /* less than 2^20 tiles of 2^16 words */
    for (uint32_t t = 0; t < tile_count; ++t) {
        const pliant_format_field* fields = asset->fields + (size_t)t * dimension;
        const uint64_t left = rest_tiles(context) - (uint64_t)t * PLIANT_FORMAT_COMPACT_PARTS;
        uint32_t bits = 0, worst = 0;
        if (asset->tiles[t].offset != words) return PLIANT_ERROR_LAYOUT;
        if (!is_size(asset->tiles[t].factor)) return PLIANT_ERROR_NUMBER;
        for (uint32_t j = 0; j < dimension; ++j) {
            bits += fields[j].width;
            worst = fields[j].width > worst ? fields[j].width : worst;
        }
        if (worst > PLIANT_FORMAT_MAX_WIDTH) return PLIANT_ERROR_LAYOUT;
        words
            += pliant_format_compact_part(bits) * (left < PLIANT_FORMAT_COMPACT_PARTS ? left : PLIANT_FORMAT_COMPACT_PARTS);
    }
    return words * sizeof(uint32_t) == data_size ? PLIANT_OK : PLIANT_ERROR_LAYOUT;
}

static pliant_result open_compact(const pliant_open_context* context, const pliant_format_chunk* chunk, pliant_asset* asset)
{
    const unsigned char* start = context->blob + chunk->offset;
    const uint32_t dimension = context->header.dimension;
    const uint64_t tile_count = (rest_tiles(context) + PLIANT_FORMAT_COMPACT_PARTS - 1) / PLIANT_FORMAT_COMPACT_PARTS;
    pliant_format_compact head;
    if (!(chunk->flags & PLIANT_CHUNK_FLAG_REQUIRED) || chunk->size < sizeof head) return PLIANT_ERROR_LAYOUT;
    memcpy(&head, start, sizeof head);
    if (head.tile_count != tile_count || !pliant_is_zero(head.reserved, sizeof head.reserved)) return PLIANT_ERROR_LAYOUT;
    if (!is_size(head.position_error)) return PLIANT_ERROR_NUMBER;
    /* At most 2^20 tiles of 256 columns of 8 bytes: no sum below can wrap around. */
    const uint64_t data = pliant_format_compact_data(dimension, head.tile_count);
    const uint64_t fields = pliant_format_compact_fields(dimension, head.tile_count);
    if (chunk->size < data) return PLIANT_ERROR_LAYOUT;
    asset->columns = (const pliant_format_column*)(const void*)(start + sizeof head);
    asset->tiles = (const pliant_format_tile*)(const void*)(start + pliant_format_compact_tiles(dimension));
    asset->fields = (const pliant_format_field*)(const void*)(start + fields);
    asset->data = (const uint32_t*)(const void*)(start + data);
    const uint64_t fields_end = fields + tile_count * dimension * sizeof(pliant_format_field);
    if (!pliant_is_zero(start + fields_end, (size_t)(data - fields_end))) return PLIANT_ERROR_LAYOUT;
    const pliant_result result = check_columns(asset->columns, dimension);
    return result == PLIANT_OK ? check_tiles(context, asset, head.tile_count, chunk->size - data) : result;
}

/* R19 of BNDS. */
static pliant_result open_bounds(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_BOUNDS);
    uint64_t end;
    if (!chunk) return PLIANT_OK;
    const pliant_result result = pliant_open_count(context, chunk, PLIANT_FORMAT_MAX_CLUSTERS, &asset->cluster_count);
    if (result != PLIANT_OK) return result;
    const uint64_t intervals = asset->cluster_count * (1 + (uint64_t)context->header.dimension);
    if (!pliant_fits(sizeof(pliant_format_count), intervals, sizeof(pliant_format_interval), chunk->size, &end)
        || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    asset->bounds
        = (const pliant_format_interval*)(const void*)(context->blob + chunk->offset + sizeof(pliant_format_count));
    if (!pliant_all_finite(asset->bounds, 6 * intervals)) return PLIANT_ERROR_NUMBER;
    for (uint64_t i = 0; i < intervals; ++i)
        for (int c = 0; c < 3; ++c)
            if (asset->bounds[i].radius[c] < 0.0f) return PLIANT_ERROR_NUMBER;
    return PLIANT_OK;
}

pliant_result pliant_open_shape(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* rest = pliant_open_find(context, PLIANT_CHUNK_REST);
    const pliant_format_chunk* basis = pliant_open_find(context, PLIANT_CHUNK_BASIS);
    const pliant_format_chunk* compact = pliant_open_find(context, PLIANT_CHUNK_COMPACT);
    uint64_t end;
    if (!pliant_fits(0, rest_tiles(context), PLIANT_FORMAT_TILE_FLOATS * sizeof(float), rest->size, &end)
        || end != rest->size)
        return PLIANT_ERROR_LAYOUT;
    asset->rest = (const float*)(const void*)(context->blob + rest->offset);
    const pliant_result result = compact ? open_compact(context, compact, asset) : open_floats(context, basis, asset);
    return result == PLIANT_OK ? open_bounds(context, asset) : result;
}
