/* Opening what a frame reads: the weights of layers, the surrogate energy, the start and the dead load. formats/SPEC.md
   section 4, LAYR, ELEM, QUAR, PRED and LOAD. */
#include "open.h"

/* R23 of LAYR. It decides what the elements are, and comes before them. */
static pliant_result open_layers(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_LAYERS);
    uint32_t count;
    uint64_t end;
    if (!chunk) return PLIANT_OK;
    const pliant_result result = pliant_open_count(context, chunk, PLIANT_FORMAT_MAX_LAYERS, &count);
    if (result != PLIANT_OK) return result;
    if (!(chunk->flags & PLIANT_CHUNK_FLAG_REQUIRED) || count != context->header.pose_count - 1) return PLIANT_ERROR_LAYOUT;
    if (pliant_open_find(context, PLIANT_CHUNK_QUARTIC)) return PLIANT_ERROR_LAYOUT;
    if (!pliant_fits(sizeof(pliant_format_count), count, sizeof(pliant_format_layer), chunk->size, &end)
        || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    const unsigned char* start = context->blob + chunk->offset + sizeof(pliant_format_count);
    asset->layers = (const pliant_format_layer*)(const void*)start;
    asset->has_layers = 1;
    for (uint32_t k = 0; k < count; ++k) {
        const pliant_format_layer* layer = &asset->layers[k];
        if (!pliant_all_finite(layer, 3)) return PLIANT_ERROR_NUMBER;
        if (layer->reserved != 0) return PLIANT_ERROR_LAYOUT; /* R14 */
        if (!(layer->low < layer->high) || layer->low > 0.0f || layer->high < 0.0f) return PLIANT_ERROR_NUMBER;
        if (layer->initial < layer->low || layer->initial > layer->high) return PLIANT_ERROR_NUMBER;
    }
    return PLIANT_OK;
}

/* `count` rows of `lanes` floats at `offset` of the chunk: inside it, aligned, finite. */
static pliant_result check_lanes(const pliant_open_context* context, const pliant_format_chunk* chunk, uint64_t data_start,
                                 uint64_t offset, uint64_t count, uint64_t lanes)
{
    uint64_t end;
    if (offset % PLIANT_FORMAT_CHUNK_ALIGNMENT != 0 || offset < data_start) return PLIANT_ERROR_LAYOUT;
    if (!pliant_fits(offset, count, lanes * sizeof(float), chunk->size, &end)) return PLIANT_ERROR_LAYOUT;
    return pliant_all_finite(context->blob + chunk->offset + offset, count * lanes) ? PLIANT_OK : PLIANT_ERROR_NUMBER;
}

/* R17: a tetrahedron's rows at z = 0 are the identity, in every lane. */
static int are_identities(const float* rows, uint64_t lanes)
{
    uint32_t bad = 0;
    for (uint32_t r = 0; r < 9; ++r)
        for (uint64_t l = 0; l < lanes; ++l) bad |= (uint32_t)(rows[r * lanes + l] != (r % 4 == 0 ? 1.0f : 0.0f));
    return bad == 0;
}

/* R05, R09, R14 and R23 of a record. */
static pliant_result check_record(const pliant_format_batch* batch, int has_layers, uint32_t pose_count)
{
    const int is_arap = batch->kind == PLIANT_ELEMENT_ARAP_CELL || batch->kind == PLIANT_ELEMENT_LAYERED_ARAP_CELL;
    const uint32_t first = has_layers ? PLIANT_ELEMENT_TIE : PLIANT_ELEMENT_HINGE;
    const uint32_t last = has_layers ? PLIANT_ELEMENT_LAYERED_ARAP_CELL : PLIANT_ELEMENT_TIE;
    if (batch->kind < first || batch->kind > last) return PLIANT_ERROR_LAYOUT;
    if (batch->element_count < 1 || batch->element_count > PLIANT_FORMAT_MAX_ELEMENTS) return PLIANT_ERROR_LIMIT;
    if (is_arap && (batch->valence < 2 || batch->valence > PLIANT_FORMAT_MAX_VALENCE)) return PLIANT_ERROR_LIMIT;
    if (!is_arap && (batch->valence != 0 || batch->is_closed != 0)) return PLIANT_ERROR_LAYOUT;
    if (batch->is_closed > 1 || (batch->is_closed == 1 && batch->valence < 3)) return PLIANT_ERROR_LAYOUT;
    if (!pliant_is_zero(batch->reserved, sizeof batch->reserved)) return PLIANT_ERROR_LAYOUT;
    if (!has_layers) return batch->changes_offset == 0 && batch->change_count == 0 ? PLIANT_OK : PLIANT_ERROR_LAYOUT;
    const size_t groups = pliant_pad_lanes(batch->element_count) / PLIANT_LANES;
    return batch->change_count <= (pose_count - 1) * groups ? PLIANT_OK : PLIANT_ERROR_LIMIT;
}

/* R24: how layers change the numbers of a batch. The records first, then the changes, 16 of each of its numbers a record. */
static pliant_result check_changes(const pliant_open_context* context, const pliant_format_chunk* chunk, uint64_t data_start,
                                   const pliant_format_batch* batch, uint32_t numbers)
{
    const uint32_t layer_count = context->header.pose_count - 1;
    const size_t group_count = pliant_pad_lanes(batch->element_count) / PLIANT_LANES;
    const uint64_t offset = batch->changes_offset;
    uint64_t end;
    if (offset % PLIANT_FORMAT_CHUNK_ALIGNMENT != 0 || offset < data_start) return PLIANT_ERROR_LAYOUT;
    if (!pliant_fits(offset, batch->change_count, sizeof(pliant_format_change), chunk->size, &end))
        return PLIANT_ERROR_LAYOUT;
    const unsigned char* start = context->blob + chunk->offset;
    const pliant_format_change* changes = (const pliant_format_change*)(const void*)(start + offset);
    for (uint32_t i = 0; i < batch->change_count; ++i) {
        if (changes[i].layer >= layer_count || changes[i].group >= group_count) return PLIANT_ERROR_INDEX;
        if (i == 0) continue;
        const pliant_format_change* before = &changes[i - 1];
        const int ascends
            = before->layer < changes[i].layer || (before->layer == changes[i].layer && before->group < changes[i].group);
        if (!ascends) return PLIANT_ERROR_INDEX;
    }
    const uint64_t numbers_start = offset + pliant_format_change_floats_offset(batch->change_count);
    if (numbers_start > chunk->size) return PLIANT_ERROR_LAYOUT;
    if (!pliant_is_zero(start + end, (size_t)(numbers_start - end))) return PLIANT_ERROR_LAYOUT;
    return check_lanes(context, chunk, data_start, numbers_start, batch->change_count * (uint64_t)numbers, PLIANT_LANES);
}

static pliant_result check_batch(const pliant_open_context* context, const pliant_format_chunk* chunk, uint64_t data_start,
                                 const pliant_format_batch* batch, int has_layers)
{
    const pliant_format_header* h = &context->header;
    pliant_result result = check_record(batch, has_layers, h->pose_count);
    if (result != PLIANT_OK) return result;

    /* From here the counts are small (at most 257 * 96 rows of 2^22 lanes): their products fit in 64 bits easily. */
    const pliant_format_shape shape = pliant_format_batch_shape(batch->kind, batch->valence, batch->is_closed);
    const uint64_t lanes = pliant_pad_lanes(batch->element_count);
    const uint64_t rows = (1 + (uint64_t)h->dimension) * shape.row_count;
    const uint64_t numbers = (has_layers ? 1 : (uint64_t)h->pose_count) * shape.pose_number_count;
    result = check_lanes(context, chunk, data_start, batch->rows_offset, rows, lanes);
    if (result == PLIANT_OK) result = check_lanes(context, chunk, data_start, batch->fixed_offset, shape.fixed_count, lanes);
    if (result == PLIANT_OK) result = check_lanes(context, chunk, data_start, batch->pose_offset, numbers, lanes);
    if (result == PLIANT_OK && has_layers)
        result = check_changes(context, chunk, data_start, batch, shape.pose_number_count);
    const int is_tet = batch->kind == PLIANT_ELEMENT_TET_STVK || batch->kind == PLIANT_ELEMENT_TET_MOONEY_RIVLIN;
    if (result != PLIANT_OK || !is_tet) return result;
    const float* at_zero = (const float*)(const void*)(context->blob + chunk->offset + batch->rows_offset);
    return are_identities(at_zero, lanes) ? PLIANT_OK : PLIANT_ERROR_NUMBER;
}

/* Bytes of the arrays of a batch that is good. */
static uint64_t size_of_arrays(const pliant_format_batch* batch, const pliant_format_header* header, int has_layers)
{
    const pliant_format_shape shape = pliant_format_batch_shape(batch->kind, batch->valence, batch->is_closed);
    const uint64_t numbers = (has_layers ? 1 : (uint64_t)header->pose_count) * shape.pose_number_count;
    const uint64_t rows = (1 + (uint64_t)header->dimension) * shape.row_count + shape.fixed_count + numbers;
    const uint64_t of_change = sizeof(pliant_format_change) + shape.pose_number_count * PLIANT_LANES * sizeof(float);
    return rows * pliant_pad_lanes(batch->element_count) * sizeof(float) + batch->change_count * of_change;
}

static pliant_result open_elements(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_ELEMENTS);
    uint32_t count;
    uint64_t data_start, data_size = 0;
    pliant_result result = pliant_open_count(context, chunk, PLIANT_FORMAT_MAX_BATCHES, &count);
    if (result != PLIANT_OK) return result;
    if (!pliant_fits(sizeof(pliant_format_count), count, sizeof(pliant_format_batch), chunk->size, &data_start))
        return PLIANT_ERROR_LAYOUT;
    asset->elements = context->blob + chunk->offset;
    asset->batches = asset->elements + sizeof(pliant_format_count);
    asset->batch_count = count;
    for (uint32_t i = 0; i < count; ++i) {
        const pliant_format_batch* batch = (const pliant_format_batch*)asset->batches + i;
        result = check_batch(context, chunk, data_start, batch, asset->layers != NULL);
        if (result != PLIANT_OK) return result;
        data_size += size_of_arrays(batch, &context->header, asset->layers != NULL);
        if (data_size > chunk->size - data_start) return PLIANT_ERROR_LAYOUT; /* a batch may not be read again and again */
    }
    return PLIANT_OK;
}

/* Of a table of QUAR: what is before and behind the tails of the rows and behind the last row, and the constant term, which
   is its first number. */
static int has_zero_padding(const float* table, uint32_t dimension)
{
    const uint32_t pairs = pliant_format_quartic_pair(dimension, dimension + 1);
    const uint32_t end = pliant_format_quartic_row_end(dimension);
    const float* row = table;
    int is_zero = pliant_is_zero(table, sizeof *table);
    for (uint32_t j = 0; j <= dimension; ++j) {
        const uint32_t start = pliant_format_quartic_row_start(dimension, j);
        const uint32_t tail = pliant_format_quartic_pair(dimension, j);
        for (uint32_t i = 0; i <= j; ++i, row += end - start) {
            is_zero &= pliant_is_zero(row, (tail - start) * sizeof *row);
            is_zero &= pliant_is_zero(row + (pairs - start), (end - pairs) * sizeof *row);
        }
    }
    const size_t floats = (size_t)(row - table);
    return is_zero && pliant_is_zero(row, (pliant_pad_lanes(floats) - floats) * sizeof *row);
}

static pliant_result open_quartic(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_QUARTIC);
    const uint32_t d = context->header.dimension, m = context->header.pose_count;
    uint32_t count;
    uint64_t end;
    if (d > PLIANT_FORMAT_MAX_QUARTIC_DIMENSION) return PLIANT_ERROR_LIMIT;
    const pliant_result result = pliant_open_count(context, chunk, UINT32_MAX, &count);
    if (result != PLIANT_OK) return result;
    if (!(chunk->flags & PLIANT_CHUNK_FLAG_REQUIRED)) return PLIANT_ERROR_LAYOUT; /* R16 */
    if (count != pliant_format_quartic_floats(d)) return PLIANT_ERROR_LAYOUT;     /* R16 */
    const uint64_t floats = pliant_pad_lanes(count);
    if (!pliant_fits(sizeof(pliant_format_count), m, floats * sizeof(float), chunk->size, &end) || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    asset->quartic = (const float*)(const void*)(context->blob + chunk->offset + sizeof(pliant_format_count));
    asset->quartic_floats = floats;
    if (!pliant_all_finite(asset->quartic, m * floats)) return PLIANT_ERROR_NUMBER;
    for (uint32_t k = 0; k < m; ++k)
        if (!has_zero_padding(asset->quartic + k * floats, d)) return PLIANT_ERROR_LAYOUT; /* R14 */
    return PLIANT_OK;
}

static pliant_result open_predictor(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_PREDICTOR);
    const uint64_t m = context->header.pose_count;
    uint32_t count;
    uint64_t centres_end, end;
    if (!chunk) return PLIANT_OK;
    const pliant_result result = pliant_open_count(context, chunk, PLIANT_FORMAT_MAX_CENTRES, &count);
    if (result != PLIANT_OK) return result;
    if (!pliant_fits(sizeof(pliant_format_count), count, m * sizeof(float), chunk->size, &centres_end))
        return PLIANT_ERROR_LAYOUT;
    const uint64_t coefficients_start = (centres_end + 63) & ~(uint64_t)63;
    if (!pliant_fits(coefficients_start, count + m, context->dimension * sizeof(float), chunk->size, &end)
        || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    const unsigned char* start = context->blob + chunk->offset;
    if (!pliant_is_zero(start + centres_end, (size_t)(coefficients_start - centres_end))) return PLIANT_ERROR_LAYOUT;
    asset->predictor_count = count;
    asset->predictor_centres = (const float*)(const void*)(start + sizeof(pliant_format_count));
    asset->predictor_coefficients = (const float*)(const void*)(start + coefficients_start);
    if (!pliant_all_finite(asset->predictor_centres, count * m)) return PLIANT_ERROR_NUMBER;
    return pliant_all_finite(asset->predictor_coefficients, (count + m) * context->dimension) ? PLIANT_OK
                                                                                              : PLIANT_ERROR_NUMBER;
}

/* It shares the centres of the predictor, which must have been opened. */
static pliant_result open_load(const pliant_open_context* context, pliant_asset* asset)
{
    const pliant_format_chunk* chunk = pliant_open_find(context, PLIANT_CHUNK_LOAD);
    uint32_t count;
    uint64_t end;
    if (!chunk) return PLIANT_OK;
    const pliant_result result = pliant_open_count(context, chunk, PLIANT_FORMAT_MAX_CENTRES, &count);
    if (result != PLIANT_OK) return result;
    if (!(chunk->flags & PLIANT_CHUNK_FLAG_REQUIRED)) return PLIANT_ERROR_LAYOUT; /* R15 */
    if (count != asset->predictor_count) return PLIANT_ERROR_LAYOUT;              /* R15: 0 without a predictor */
    const uint64_t rows = (uint64_t)count + context->header.pose_count;
    if (!pliant_fits(sizeof(pliant_format_count), rows, context->dimension * sizeof(float), chunk->size, &end)
        || end != chunk->size)
        return PLIANT_ERROR_LAYOUT;
    const float* row = (const float*)(const void*)(context->blob + chunk->offset + sizeof(pliant_format_count));
    asset->load_coefficients = row;
    if (!pliant_all_finite(row, rows * context->dimension)) return PLIANT_ERROR_NUMBER;
    const uint32_t d = context->header.dimension;
    for (uint64_t i = 0; i < rows; ++i, row += context->dimension)
        if (!pliant_is_zero(row + d, (size_t)(context->dimension - d) * sizeof *row)) return PLIANT_ERROR_LAYOUT; /* R14 */
    return PLIANT_OK;
}

pliant_result pliant_open_energy(const pliant_open_context* context, pliant_asset* asset)
{
    const int has_elements = pliant_open_find(context, PLIANT_CHUNK_ELEMENTS) != NULL;
    pliant_result result = open_layers(context, asset);
    if (result == PLIANT_OK) result = has_elements ? open_elements(context, asset) : open_quartic(context, asset);
    if (result == PLIANT_OK) result = open_predictor(context, asset);
    if (result == PLIANT_OK) result = open_load(context, asset);
    return result;
}
