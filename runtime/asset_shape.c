/* Opening what positions are rebuilt from: REST, the basis in one of its three forms, and the clusters of bounding boxes. */
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

/* R18 of shifts, R14 of the padding, R19. */
static pliant_result check_columns(const pliant_format_column* columns, uint32_t dimension, uint32_t max_shift)
{
    const unsigned char* end = (const unsigned char*)(columns + dimension);
    for (uint32_t j = 0; j < dimension; ++j) {
        if (columns[j].shift > max_shift) return PLIANT_ERROR_LAYOUT;
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
    const pliant_result result = check_columns(asset->columns, dimension, PLIANT_FORMAT_MAX_SHIFT);
    return result == PLIANT_OK ? check_tiles(context, asset, head.tile_count, chunk->size - data) : result;
}

/* R22: the vertices of a tile are sorted, inside their block, and no tile before had them. */
static pliant_result check_vertices(const uint16_t* vertices, const pliant_format_product* tile, uint32_t block_size,
                                    unsigned char* seen)
{
    const uint32_t padded = pliant_format_product_parts(tile) * PLIANT_FORMAT_TILE_VERTICES;
    for (uint32_t i = 0; i < tile->vertex_count; ++i) {
        const uint32_t v = vertices[i], bit = 1u << v % 8;
        if (v >= block_size || (i > 0 && v <= vertices[i - 1]) || (seen[v / 8] & bit)) return PLIANT_ERROR_INDEX;
        seen[v / 8] = (unsigned char)(seen[v / 8] | bit);
    }
    return pliant_is_zero(vertices + tile->vertex_count, (padded - tile->vertex_count) * sizeof *vertices)
        ? PLIANT_OK
        : PLIANT_ERROR_LAYOUT;
}

/* Whether the tile's data lies where the one before it ended; `*words` becomes its end. */
static pliant_result check_product(const pliant_format_product* tile, const uint32_t* data, uint32_t dimension,
                                   uint64_t data_words, uint64_t* words)
{
    const uint64_t fields_at = pliant_format_product_fields(tile, dimension), left_at = pliant_format_product_left(tile);
    const uint64_t head_end = *words + fields_at + left_at; /* of less than 2^17 words */
    if (tile->offset != *words || head_end > data_words) return PLIANT_ERROR_LAYOUT;
    const pliant_format_field* fields = (const pliant_format_field*)(const void*)(data + *words + fields_at);
    uint32_t bits = 0, worst = 0;
    for (uint32_t j = 0; j < tile->column_count; ++j) {
        bits += fields[j].width;
        worst = fields[j].width > worst ? fields[j].width : worst;
    }
    if (worst > PLIANT_FORMAT_MAX_WIDTH) return PLIANT_ERROR_LAYOUT;
    *words = head_end + (uint64_t)pliant_format_compact_part(bits) * pliant_format_product_parts(tile);
    if (*words > data_words) return PLIANT_ERROR_LAYOUT;
    const uint32_t rows = pliant_format_product_rows(tile);
    const uint32_t* scales = data + tile->offset + pliant_format_product_parts(tile) * (PLIANT_FORMAT_TILE_VERTICES / 2);
    return pliant_all_finite(scales, rows) && pliant_all_finite(tile->rest_origin, 3) ? PLIANT_OK : PLIANT_ERROR_NUMBER;
}

static int is_product(const pliant_format_product* tile, uint32_t dimension)
{
    return tile->vertex_count >= 1 && tile->vertex_count <= PLIANT_FORMAT_COMPACT_VERTICES
        && tile->column_count <= PLIANT_FORMAT_MAX_PRODUCT_COLUMNS && tile->column_count <= dimension
        && (!pliant_format_product_is_still(tile) || tile->column_count == 0);
}

/* R21, R22: the data of a block's tiles is where it must be, and they have each of its vertices once. */
static pliant_result check_block(const pliant_open_context* context, const pliant_asset* asset, uint32_t block,
                                 uint64_t* words)
{
    unsigned char seen[PLIANT_FORMAT_MAX_BLOCK_VERTICES / 8];
    const uint64_t first = (uint64_t)block * asset->block_vertices, left = context->header.vertex_count - first;
    const uint32_t size = left < asset->block_vertices ? (uint32_t)left : asset->block_vertices;
    uint64_t count = 0; /* no vertex counts twice: so it cannot exceed the block */
    memset(seen, 0, (size + 7) / 8);
    for (uint32_t t = asset->blocks[block]; t < asset->blocks[block + 1]; ++t) {
        const pliant_format_product* tile = asset->products + t;
        if (!is_product(tile, context->header.dimension)) return PLIANT_ERROR_LAYOUT;
        if (!is_size(tile->rest_scale)) return PLIANT_ERROR_NUMBER;
        pliant_result result = check_product(tile, asset->data, context->header.dimension, asset->data_words, words);
        if (result == PLIANT_OK)
            result = check_vertices((const uint16_t*)(const void*)(asset->data + tile->offset), tile, size, seen);
        if (result != PLIANT_OK) return result;
        count += tile->vertex_count;
    }
    return count == size ? PLIANT_OK : PLIANT_ERROR_INDEX;
}

/* R21: blocks follow each other, as their tiles do. */
static pliant_result check_blocks(const pliant_open_context* context, const pliant_asset* asset, uint32_t block_count,
                                  uint32_t tile_count)
{
    uint64_t words = 0;
    if (asset->blocks[0] != 0 || asset->blocks[block_count] != tile_count) return PLIANT_ERROR_LAYOUT;
    for (uint32_t b = 0; b < block_count; ++b)
        if (asset->blocks[b] > asset->blocks[b + 1]) return PLIANT_ERROR_LAYOUT;
    for (uint32_t b = 0; b < block_count; ++b) {
        const pliant_result result = check_block(context, asset, b, &words);
        if (result != PLIANT_OK) return result;
    }
    return words == asset->data_words ? PLIANT_OK : PLIANT_ERROR_LAYOUT;
}

static int is_block_size(uint32_t vertices)
{
    return vertices >= PLIANT_FORMAT_COMPACT_VERTICES && vertices <= PLIANT_FORMAT_MAX_BLOCK_VERTICES
        && vertices % PLIANT_FORMAT_COMPACT_VERTICES == 0;
}

static pliant_result open_factored(const pliant_open_context* context, const pliant_format_chunk* chunk, pliant_asset* asset)
{
    const unsigned char* start = context->blob + chunk->offset;
    const uint32_t dimension = context->header.dimension;
    pliant_format_factored head;
    if (!(chunk->flags & PLIANT_CHUNK_FLAG_REQUIRED) || chunk->size < sizeof head) return PLIANT_ERROR_LAYOUT;
    memcpy(&head, start, sizeof head);
    if (!is_block_size(head.block_vertices) || head.tile_count > context->header.vertex_count
        || !pliant_is_zero(head.reserved, sizeof head.reserved))
        return PLIANT_ERROR_LAYOUT;
    if (!is_size(head.position_error)) return PLIANT_ERROR_NUMBER;
    /* At most 2^20 blocks and 2^26 tiles of 24 bytes: no sum below can wrap around. */
    const uint32_t block_count = pliant_format_block_count(context->header.vertex_count, head.block_vertices);
    const uint64_t tiles = pliant_format_factored_tiles(dimension, block_count);
    const uint64_t data = pliant_format_factored_data(dimension, block_count, head.tile_count);
    if (chunk->size < data || chunk->size % sizeof(uint32_t) != 0) return PLIANT_ERROR_LAYOUT;
    asset->columns = (const pliant_format_column*)(const void*)(start + sizeof head);
    asset->blocks = (const uint32_t*)(const void*)(start + pliant_format_factored_blocks(dimension));
    asset->products = (const pliant_format_product*)(const void*)(start + tiles);
    asset->data = (const uint32_t*)(const void*)(start + data);
    asset->block_vertices = head.block_vertices;
    const unsigned char* const blocks_end = (const unsigned char*)(asset->blocks + block_count + 1);
    const unsigned char* const products_end = (const unsigned char*)(asset->products + head.tile_count);
    if (!pliant_is_zero(blocks_end, (size_t)(start + tiles - blocks_end))
        || !pliant_is_zero(products_end, (size_t)(start + data - products_end)))
        return PLIANT_ERROR_LAYOUT;
    asset->data_words = (chunk->size - data) / sizeof(uint32_t);
    const pliant_result result = check_columns(asset->columns, dimension, 0);
    return result == PLIANT_OK ? check_blocks(context, asset, block_count, head.tile_count) : result;
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

static pliant_result open_rest(const pliant_open_context* context, const pliant_format_chunk* chunk, pliant_asset* asset)
{
    uint64_t end;
    if (!pliant_fits(0, rest_tiles(context), PLIANT_FORMAT_TILE_FLOATS * sizeof(float), chunk->size, &end)
        || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    asset->rest = (const float*)(const void*)(context->blob + chunk->offset);
    return PLIANT_OK;
}

pliant_result pliant_open_shape(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* rest = pliant_open_find(context, PLIANT_CHUNK_REST);
    const pliant_format_chunk* basis = pliant_open_find(context, PLIANT_CHUNK_BASIS);
    const pliant_format_chunk* compact = pliant_open_find(context, PLIANT_CHUNK_COMPACT);
    const pliant_format_chunk* factored = pliant_open_find(context, PLIANT_CHUNK_FACTORED);
    pliant_result result = PLIANT_OK;
    if (factored) {
        result = open_factored(context, factored, asset);
    } else {
        result = open_rest(context, rest, asset);
        if (result == PLIANT_OK)
            result = compact ? open_compact(context, compact, asset) : open_floats(context, basis, asset);
    }
    return result == PLIANT_OK ? open_bounds(context, asset) : result;
}
