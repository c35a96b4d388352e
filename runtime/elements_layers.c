/* Elements of layers: how the weights of a frame make elements of a plain kind out of them. Formulas: formats/SPEC.md,
   Layers and kinds 9 to 11 (kind 11's finish is in elements_arap.c).

   Layers add up in the numbers that describe an element's rest state, and are stored sparsely, as most of them move a part
   of a character only. The rest state then gives the numbers that the plain kind would have had for it, once a frame: an
   evaluation does not know that there are layers. */
#include "internal.h"
#include "lane_math.h"
#include "linalg.h"

/* Where number k of a layered kind lies among the rows of the plain one until it is finished. */
static size_t plain_row(uint32_t kind, size_t k)
{
    switch (kind) {
    case PLIANT_ELEMENT_LAYERED_HINGE: return 0;                /* the rest angle: the centre */
    case PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN: return 4 + k; /* anywhere, for it is read before it is overwritten */
    case PLIANT_ELEMENT_LAYERED_ARAP_CELL: return k / 3 * 4 + 1 + k % 3; /* p of an edge, behind its c */
    default: return k;                                                   /* ties are linear in the weights: done */
    }
}

/* numbers + sum over the records of v change */
static void add_changes(const pliant_asset* asset, const pliant_format_batch* batch, size_t number_count, size_t stride,
                        const float* weights, float* plain)
{
    const unsigned char* start = asset->elements + batch->changes_offset;
    const pliant_format_change* records = (const pliant_format_change*)(const void*)start;
    const float* change = (const float*)(const void*)(start + pliant_format_change_floats_offset(batch->change_count));
    const float* numbers = (const float*)(const void*)(asset->elements + batch->pose_offset);
    for (size_t k = 0; k < number_count; ++k)
        memcpy(plain + plain_row(batch->kind, k) * stride, numbers + k * stride, stride * sizeof *plain);
    for (uint32_t i = 0; i < batch->change_count; ++i, change += number_count * PLIANT_LANES) {
        const float weight = weights[1 + records[i].layer];
        float* group = plain + records[i].group * (size_t)PLIANT_LANES;
        if (weight == 0.0f) continue; /* most sliders of a face are at rest */
        for (size_t k = 0; k < number_count; ++k)
            pliant_add_scaled(group + plain_row(batch->kind, k) * stride, weight, change + k * PLIANT_LANES, PLIANT_LANES);
    }
}

/* The rest angle within a turn of 0: the difference to the angle of the shape then keeps its digits however far layers have
   rolled the surface up. */
static PLIANT_INLINE void finish_hinge(const pliant_element_group* group, const pliant_arap_poses* poses,
                                       float* PLIANT_RESTRICT plain)
{
    const float* fixed = group->fixed;
    const size_t s = group->stride;
    pliant_lanes out[4];
    (void)poses;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float centre = pliant_wrap_angle(plain[l]);
        out[0][l] = centre;
        out[1][l] = pliant_wrap_angle(fixed[0 * s + l] - centre);
        out[2][l] = fixed[1 * s + l];
        out[3][l] = 0.0f;
    }
    pliant_store_rows(plain, s, out, 4);
}

/* Of h, of k, and of h + k. What grows by more has coefficients (exp(-2 h) of det G, exp(-h - k) of N) below the rounding of
   those beside them: with the wrong sign they would leave the energy without a lower bound, and blends would fly away. */
#define LEAST_STRAIN (-16.0f)
#define LARGEST_STRAIN 8.0f
#define LARGEST_SHEAR 6.0f
#define LARGEST_SUM 12.0f

/* The same for det G, beside the logarithm: it keeps this part of r P at least, four units of rounding. */
#define LEAST_STIFFNESS 2.4e-7f

/* X = exp(-S) minus the identity, S = h + (p q; q -p), where the eigenvalues of S - h are +-k0. */
typedef struct inverse_stretch {
    float x11, x12, x22;
    float area, size; /* J = exp(h); exp(-2h) - 1 */
} inverse_stretch;

/* Minus the identity, since the strains of a layer are small and would lose their digits. The smaller one of X's diagonal
   entries is cosh k - sinh k for a diagonal S: written as exp(-k) plus what is positive, so that rounding cannot make X
   indefinite, which would leave the energy without a lower bound. */
static PLIANT_INLINE inverse_stretch invert_stretch(float s11, float s12, float s22)
{
    const float mean = 0.5f * s11 + 0.5f * s22, p = 0.5f * s11 - 0.5f * s22, q = s12;
    const float h0 = mean < LARGEST_STRAIN ? mean : LARGEST_STRAIN;
    const float h = h0 > LEAST_STRAIN ? h0 : LEAST_STRAIN;
    const float ap = fabsf(p), aq = fabsf(q);
    const float large = ap < aq ? aq : ap, small = ap < aq ? ap : aq;
    const float t = small / (large > 0.0f ? large : 1.0f); /* squares of the numbers themselves would overflow */
    const float k0 = large * sqrtf(1.0f + t * t);
    const float left = LARGEST_SUM - h, most = left < LARGEST_SHEAR ? left : LARGEST_SHEAR;
    const float k = k0 < most ? k0 : most;
    const float cut = k0 < most ? 1.0f : most / k0;
    const float grown = pliant_expm1(k), shrunk = -grown / (1.0f + grown); /* exp(k) - 1, exp(-k) - 1 */
    const float ratio = cut * pliant_sinh_ratio(k, 1.0f + grown);
    const float sum = k0 + ap;
    const float low = shrunk + ratio * (aq * (aq / (sum > 0.0f ? sum : 1.0f))); /* aq^2 / (k0 + ap) = k0 - ap */
    const float high = 0.5f * (grown + shrunk) + ratio * ap;
    const float x11 = p > 0.0f ? low : high, x22 = p > 0.0f ? high : low;
    /* exp(|h|) - 1 and exp(-|h|) - 1: 1 added to the second one of a small shape would have no digits left. */
    const float wider = pliant_expm1(fabsf(h)), inverse = 1.0f / (1.0f + wider), narrower = -wider * inverse;
    const float scale = h > 0.0f ? narrower : wider; /* exp(-h) - 1 */
    inverse_stretch x;
    x.x11 = x11 + scale * (1.0f + x11);
    x.x22 = x22 + scale * (1.0f + x22);
    x.x12 = -(h > 0.0f ? inverse : 1.0f + wider) * ratio * q;
    x.area = h > 0.0f ? 1.0f + wider : inverse;
    x.size = scale * (2.0f + scale);
    return x;
}

static PLIANT_INLINE void finish_face_neo_hookean(const pliant_element_group* group, const pliant_arap_poses* poses,
                                                  float* PLIANT_RESTRICT plain)
{
    const float* fixed = group->fixed;
    const size_t s = group->stride;
    pliant_lanes out[9];
    (void)poses;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        const float i11 = fixed[0 * s + l], i12 = fixed[1 * s + l], i22 = fixed[2 * s + l], r = fixed[3 * s + l];
        const float e11 = fixed[4 * s + l], e12 = fixed[5 * s + l], e22 = fixed[6 * s + l];
        const float a = fixed[7 * s + l], b = fixed[8 * s + l];
        const inverse_stretch x = invert_stretch(plain[4 * s + l], plain[5 * s + l], plain[6 * s + l]);

        /* N - i with N = E X E^T, the inverse metric of the rest state: E (X - 1) E^T, and what i and r differ from E E^T
           and its determinant by, which is their rounding if the shape at z = 0 is the rest shape. */
        const double f11 = (double)e11, f12 = (double)e12, f22 = (double)e22;
        const float y11 = e11 * x.x11 + e12 * x.x12, y12 = e11 * x.x12 + e12 * x.x22;
        const float n11 = y11 * e11 + y12 * e12 + (float)(f11 * f11 + f12 * f12 - (double)i11);
        const float n12 = y12 * e22 + (float)(f12 * f22 - (double)i12);
        const float n22 = e22 * x.x22 * e22 + (float)(f22 * f22 - (double)i22);
        const float start = (float)(f11 * f22 * (f11 * f22) / (double)r - 1.0);
        const float ratio = start + (1.0f + start) * x.size; /* rho - 1 */

        const float shape = a * x.area, size = b * x.area * ratio;
        out[0][l] = i11;
        out[1][l] = i12;
        out[2][l] = i22;
        out[3][l] = r;
        out[4][l] = shape * n11 + size * i11;
        out[5][l] = 2.0f * (shape * n12 + size * i12);
        out[6][l] = shape * n22 + size * i22;
        const float barrier = x.area * (a + b), area = r * x.area * (b * ratio - a);
        const float least = -(1.0f - LEAST_STIFFNESS) * r * barrier;
        out[7][l] = area > least ? area : least;
        out[8][l] = barrier;
    }
    pliant_store_rows(plain, s, out, 9);
}

PLIANT_KERNEL(finish_hinge,
              (const pliant_element_group* group, const pliant_arap_poses* poses, float* PLIANT_RESTRICT plain),
              (group, poses, plain))
PLIANT_KERNEL(finish_face_neo_hookean,
              (const pliant_element_group* group, const pliant_arap_poses* poses, float* PLIANT_RESTRICT plain),
              (group, poses, plain))

static pliant_finish_kernel* choose_finish(const pliant_kernels* kernels, uint32_t kind)
{
    switch (kind) {
    case PLIANT_ELEMENT_LAYERED_HINGE: return kernels->finish_hinge;
    case PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN: return kernels->finish_face_neo_hookean;
    case PLIANT_ELEMENT_LAYERED_ARAP_CELL: return kernels->finish_arap_cell;
    default: return NULL;
    }
}

void pliant_layers_combine(const pliant_kernels* kernels, const pliant_asset* asset, const pliant_format_batch* batch,
                           const float* weights, float* plain)
{
    const pliant_format_shape shape = pliant_format_batch_shape(batch->kind, batch->valence, batch->is_closed);
    const size_t stride = pliant_pad_lanes(batch->element_count);
    const float* rows = (const float*)(const void*)(asset->elements + batch->rows_offset);
    const float* fixed = (const float*)(const void*)(asset->elements + batch->fixed_offset);
    const pliant_arap_poses poses = { batch->valence, shape.fixed_count, NULL, 0, 0, 1 };
    pliant_finish_kernel* finish = choose_finish(kernels, batch->kind);
    add_changes(asset, batch, shape.pose_number_count, stride, weights, plain);
    for (size_t l = 0; finish && l < stride; l += PLIANT_LANES) {
        const pliant_element_group group = { rows + l, fixed + l, NULL, stride, NULL, 0 };
        finish(&group, &poses, plain + l);
    }
}
