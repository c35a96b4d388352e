/* The surrogate energy: combine once per frame, then two passes over the rows of every batch per evaluation, forward
   (differences from z) and backward (gradient from forces). The passes are memory streams and dominate; the elements between
   them work on a block of lanes that is still in the first-level cache.

   Source: combine-then-evaluate, formats/SPEC.md section 4; reduced integration by elements: von Tycowicz et al., "Real-Time
   Nonlinear Shape Interpolation", TOG 2015, section 5, and An, Kim, James, "Optimizing Cubature", TOG 2008. */
#include "internal.h"
#include "linalg.h"

/* A block holds as many lanes as keep its differences and its forces, 6 KiB each, in a 32 KiB first-level cache beside the
   columns that stream through. */
#define BLOCK_FLOATS 1536u

typedef struct batch_view {
    uint32_t kind; /* that it is evaluated as: of layers the plain one */
    int is_layered;
    uint32_t valence;
    uint32_t edge_count; /* of an ARAP cell */
    size_t row_count;
    size_t fixed_count;
    size_t pose_number_count;
    size_t stride; /* padded element count */
    const float* rows;
    const float* fixed;
    const float* pose_numbers;
} batch_view;

static batch_view view_batch(const pliant_asset* asset, uint32_t index)
{
    const pliant_format_batch* batch = (const pliant_format_batch*)asset->batches + index;
    const uint32_t kind = pliant_plain_kind(batch->kind);
    const pliant_format_shape shape = pliant_format_batch_shape(kind, batch->valence, batch->is_closed);
    batch_view view;
    view.kind = kind;
    view.is_layered = asset->layers != NULL;
    view.valence = batch->valence;
    view.edge_count = batch->valence + (batch->is_closed ? batch->valence : batch->valence - 1);
    view.row_count = shape.row_count;
    view.fixed_count = shape.fixed_count;
    view.pose_number_count = shape.pose_number_count;
    if (view.is_layered && kind == PLIANT_ELEMENT_ARAP_CELL) ++view.pose_number_count; /* see pliant_arap_poses */
    view.stride = pliant_pad_lanes(batch->element_count);
    view.rows = (const float*)(const void*)(asset->elements + batch->rows_offset);
    view.fixed = (const float*)(const void*)(asset->elements + batch->fixed_offset);
    view.pose_numbers = (const float*)(const void*)(asset->elements + batch->pose_offset);
    return view;
}

/* Of averages, ARAP takes the best rotation per pose: its numbers cannot be combined. */
static int is_combined(const batch_view* batch) { return batch->is_layered || batch->kind != PLIANT_ELEMENT_ARAP_CELL; }

/* Layers change fixed numbers, too. */
static size_t combined_floats(const batch_view* batch)
{
    const size_t fixed = batch->is_layered ? batch->fixed_count : 0;
    return is_combined(batch) ? (fixed + batch->pose_number_count) * batch->stride : 0;
}

/* Fixed numbers and numbers where they are: those of layers are both among the combined ones. */
static void locate_numbers(batch_view* batch, const float* combined)
{
    if (batch->is_layered) {
        batch->fixed = combined;
        batch->pose_numbers = combined + batch->fixed_count * batch->stride;
    } else if (is_combined(batch))
        batch->pose_numbers = combined;
}

static size_t block_lanes(size_t row_count)
{
    const size_t lanes = BLOCK_FLOATS / row_count / PLIANT_LANES * PLIANT_LANES;
    return lanes > 0 ? lanes : PLIANT_LANES;
}

pliant_energy_layout pliant_elements_measure(const pliant_asset* asset)
{
    pliant_energy_layout layout = { 0, 0 };
    for (uint32_t i = 0; i < asset->batch_count; ++i) {
        const batch_view batch = view_batch(asset, i);
        const uint64_t block = (uint64_t)batch.row_count * block_lanes(batch.row_count);
        layout.combined_floats += combined_floats(&batch);
        if (layout.scratch_floats < 2 * block) layout.scratch_floats = 2 * block;
    }
    return layout;
}

void pliant_elements_combine(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights, float* combined)
{
    for (uint32_t i = 0; i < asset->batch_count; ++i) {
        const batch_view batch = view_batch(asset, i);
        const size_t count = combined_floats(&batch);
        if (batch.is_layered)
            pliant_layers_combine(kernels, asset, (const pliant_format_batch*)asset->batches + i, weights, combined);
        else if (count > 0)
            kernels->combine_columns(combined, batch.pose_numbers, weights, asset->pose_count, count);
        combined += count;
    }
}

/* change = sum over j of z[j] * rows[1+j], for `lanes` lanes. Without rows[0]: the elements want the change by itself,
   free of cancellation. Four columns at a time, so that four loads share one trip of the sum to the cache. */
static PLIANT_INLINE void add_four_columns(float* PLIANT_RESTRICT change, const float* PLIANT_RESTRICT columns,
                                           size_t column_floats, const float* z, size_t row_count, size_t stride,
                                           size_t lanes)
{
    const float z0 = z[0], z1 = z[1], z2 = z[2], z3 = z[3];
    for (size_t r = 0; r < row_count; ++r) {
        float* PLIANT_RESTRICT out = change + r * lanes;
        const float* c0 = columns + r * stride;
        const float* c1 = c0 + column_floats;
        const float* c2 = c1 + column_floats;
        const float* c3 = c2 + column_floats;
        for (size_t l = 0; l < lanes; ++l) out[l] += (z0 * c0[l] + z1 * c1[l]) + (z2 * c2[l] + z3 * c3[l]);
    }
}

static PLIANT_INLINE void add_column(float* PLIANT_RESTRICT change, const float* PLIANT_RESTRICT column, float z,
                                     size_t row_count, size_t stride, size_t lanes)
{
    for (size_t r = 0; r < row_count; ++r) pliant_add_scaled(change + r * lanes, z, column + r * stride, lanes);
}

static PLIANT_INLINE void pass_forward(const pliant_block* block, const float* z, float* change)
{
    const size_t rows = block->row_count, stride = block->stride, lanes = block->lanes;
    const float* column = block->columns;
    size_t j = 0;
    memset(change, 0, rows * lanes * sizeof *change);
    for (; j + 4 <= block->column_count; j += 4, column += 4 * block->column_floats)
        add_four_columns(change, column, block->column_floats, z + j, rows, stride, lanes);
    for (; j < block->column_count; ++j, column += block->column_floats)
        add_column(change, column, z[j], rows, stride, lanes);
}

/* gradient[0..1] += <force, two columns>: two share the loads of the force. */
static PLIANT_INLINE void project_two_columns(const float* PLIANT_RESTRICT force, const float* PLIANT_RESTRICT c0,
                                              const float* PLIANT_RESTRICT c1, size_t row_count, size_t stride, size_t lanes,
                                              float* PLIANT_RESTRICT gradient)
{
    float sum0[PLIANT_LANES] = { 0 };
    float sum1[PLIANT_LANES] = { 0 };
    for (size_t r = 0; r < row_count; ++r)
        for (size_t i = 0; i < lanes; i += PLIANT_LANES)
            for (size_t l = 0; l < PLIANT_LANES; ++l) {
                sum0[l] += force[r * lanes + i + l] * c0[r * stride + i + l];
                sum1[l] += force[r * lanes + i + l] * c1[r * stride + i + l];
            }
    gradient[0] += pliant_sum_lanes(sum0);
    gradient[1] += pliant_sum_lanes(sum1);
}

static PLIANT_INLINE void project_column(const float* PLIANT_RESTRICT force, const float* PLIANT_RESTRICT column,
                                         size_t row_count, size_t stride, size_t lanes, float* gradient)
{
    float sum[PLIANT_LANES] = { 0 };
    for (size_t r = 0; r < row_count; ++r)
        for (size_t i = 0; i < lanes; i += PLIANT_LANES)
            for (size_t l = 0; l < PLIANT_LANES; ++l) sum[l] += force[r * lanes + i + l] * column[r * stride + i + l];
    *gradient += pliant_sum_lanes(sum);
}

static PLIANT_INLINE void pass_backward(const pliant_block* block, const float* force, float* gradient)
{
    const size_t rows = block->row_count, stride = block->stride, lanes = block->lanes;
    const float* column = block->columns;
    size_t j = 0;
    for (; j + 2 <= block->column_count; j += 2, column += 2 * block->column_floats)
        project_two_columns(force, column, column + block->column_floats, rows, stride, lanes, gradient + j);
    if (j < block->column_count) project_column(force, column, rows, stride, lanes, gradient + j);
}

PLIANT_KERNEL(pass_forward, (const pliant_block* block, const float* z, float* change), (block, z, change))
PLIANT_KERNEL(pass_backward, (const pliant_block* block, const float* force, float* gradient), (block, force, gradient))

static void evaluate_group(const pliant_kernels* kernels, uint32_t kind, const pliant_element_group* group,
                           const pliant_arap_poses* poses, float* force, float* energy)
{
    switch (kind) {
    case PLIANT_ELEMENT_HINGE: kernels->evaluate_hinge(group, force, energy); break;
    case PLIANT_ELEMENT_FACE_NEO_HOOKEAN: kernels->evaluate_face_neo_hookean(group, force, energy); break;
    case PLIANT_ELEMENT_FACE_STVK: kernels->evaluate_face_stvk(group, force, energy); break;
    case PLIANT_ELEMENT_FACE_EDGE: kernels->evaluate_face_edge(group, force, energy); break;
    case PLIANT_ELEMENT_TET_STVK: kernels->evaluate_tet_stvk(group, force, energy); break;
    case PLIANT_ELEMENT_TET_MOONEY_RIVLIN: kernels->evaluate_tet_mooney_rivlin(group, force, energy); break;
    case PLIANT_ELEMENT_TIE: kernels->evaluate_tie(group, force, energy); break;
    default: /* ARAP; pliant_asset_open lets no other kind pass */
        kernels->evaluate_arap_cell(group, poses, force, energy);
        break;
    }
}

/* Lanes are added in double: their sum is where the small energy differences of a line search would be lost. */
static double sum_energy(const float* energy)
{
    double sum = 0.0;
    for (int l = 0; l < (int)PLIANT_LANES; ++l) sum += (double)energy[l];
    return sum;
}

double pliant_elements_evaluate(const pliant_kernels* kernels, const pliant_asset* asset, const float* weights,
                                const float* combined, const float* z, float* gradient, float* scratch)
{
    double total = 0.0;
    const float one = 1.0f;
    memset(gradient, 0, asset->padded_dimension * sizeof *gradient);
    for (uint32_t i = 0; i < asset->batch_count; ++i) {
        batch_view batch = view_batch(asset, i);
        locate_numbers(&batch, combined);
        combined += combined_floats(&batch);
        const size_t size = block_lanes(batch.row_count), column_floats = batch.row_count * batch.stride;
        const pliant_arap_poses poses = { batch.valence,
                                          batch.edge_count,
                                          batch.is_layered ? &one : weights,
                                          batch.is_layered ? 1 : asset->pose_count,
                                          batch.pose_number_count * batch.stride,
                                          batch.is_layered };
        for (size_t first = 0; first < batch.stride; first += size) {
            const size_t lanes = batch.stride - first < size ? batch.stride - first : size;
            const pliant_block block = {
                batch.rows + column_floats + first, column_floats, asset->dimension, batch.row_count, batch.stride, lanes
            };
            float* change = scratch;
            float* force = scratch + batch.row_count * size;
            float energy[PLIANT_LANES] = { 0 };
            kernels->pass_forward(&block, z, change);
            for (size_t l = 0; l < lanes; l += PLIANT_LANES) {
                const pliant_element_group group = { batch.rows + first + l,
                                                     batch.fixed + first + l,
                                                     batch.pose_numbers + first + l,
                                                     batch.stride,
                                                     change + l,
                                                     lanes };
                evaluate_group(kernels, batch.kind, &group, &poses, force + l, energy);
            }
            total += sum_energy(energy);
            kernels->pass_backward(&block, force, gradient);
        }
    }
    return total;
}
