/* Blends of layers: what their weights are, any finite ones, the ranges, blends whose answer is known, rest angles of many
   turns, and the numbers that weights make of elements against the formulas of formats/SPEC.md in double precision. */
#include "internal.h"
#include "support.h"

#include <float.h>
#include <math.h>

static int layered_count, turned_count;

/* ------------------------------------------------------------------------------------------------------ elements ---- */

static float signed_unit(uint64_t* state) { return 2.0f * random_unit(state) - 1.0f; }

/* The example of the SPEC: rest angle 0.25 + 2 * 0.5, angle 1; and one that is three turns further. */
static void check_hinge_example(void)
{
    for (int turns = -3; turns <= 3; ++turns) {
        float fixed[2][PLIANT_LANES], plain[4][PLIANT_LANES];
        const pliant_element_group group = { NULL, fixed[0], NULL, PLIANT_LANES, NULL, 0 };
        for (size_t l = 0; l < PLIANT_LANES; ++l) {
            fixed[0][l] = 0.25f;
            fixed[1][l] = 2.0f;
            plain[0][l] = 1.25f + (float)turns * 6.28318531f;
        }
        pliant_finish_hinge(&group, NULL, plain[0]);
        const double centre = (double)plain[0][3], t0 = (double)plain[1][3], beta = (double)plain[2][3];
        const double t = remainder(1.0 - centre, 2.0 * acos(-1.0));
        CHECK(fabs((t - t0) * beta * (t + t0) + 1.875) < 1e-5 && plain[3][3] == 0.0f, "%d turns: centre %g, t0 %g", turns,
              centre, t0);
        CHECK(fabs(centre - 1.25) < 2e-6, "%d turns: the centre is %.9g and costs digits", turns, centre);

        fixed[0][5] = 3.0f;
        plain[0][5] = -3.0f + (float)turns * 6.28318531f;
        pliant_finish_hinge(&group, NULL, plain[0]);
        CHECK(fabs((double)plain[1][5] + 0.283185) < 5e-6, "%d turns: t0 is %g", turns, (double)plain[1][5]);
    }
}

typedef struct face_numbers {
    double fixed[9]; /* i11 i12 i22 r e11 e12 e22 a b */
    double s[3];
} face_numbers;

/* Those of kind 10, straight from the formulas: L11 L12 L22 B P. */
static void compute_face(const face_numbers* f, double numbers[5])
{
    const double *x = f->fixed, *s = f->s;
    const double h0 = (s[0] + s[2]) / 2, p = (s[0] - s[2]) / 2, k0 = hypot(p, s[1]);
    const double h = fmax(-16.0, fmin(8.0, h0)), k = fmin(fmin(6.0, 12.0 - h), k0);
    const double ratio = k0 > 0.0 ? sinh(k) / k0 : 1.0, area = exp(h);
    /* cosh k - sinh k cancels in double, too */
    const double low = exp(-k) + ratio * (k0 - fabs(p)), high = cosh(k) + ratio * fabs(p);
    const double x11 = (p > 0 ? low : high) / area, x22 = (p > 0 ? high : low) / area, x12 = -ratio * s[1] / area;
    const double e11 = x[4], e12 = x[5], e22 = x[6], a = x[7], b = x[8], r = x[3];
    const double n11 = e11 * e11 * x11 + 2 * e11 * e12 * x12 + e12 * e12 * x22, n12 = e22 * (e11 * x12 + e12 * x22);
    const double rho = e11 * e22 * e11 * e22 / (area * area) / r;
    numbers[0] = area * (a * (n11 - x[0]) + b * (rho - 1) * x[0]);
    numbers[1] = 2 * area * (a * (n12 - x[1]) + b * (rho - 1) * x[1]);
    numbers[2] = area * (a * (e22 * e22 * x22 - x[2]) + b * (rho - 1) * x[2]);
    numbers[3] = area * r * (b * rho - a - b);
    numbers[4] = area * (a + b);
}

static face_numbers random_face(uint64_t* state, float size)
{
    face_numbers f;
    const float e11 = 1.0f + random_unit(state), e12 = signed_unit(state), e22 = 1.0f + random_unit(state);
    const float values[9]
        = { e11 * e11 + e12 * e12,    e12 * e22, e22 * e22, e11 * e22 * e11 * e22, e11, e12, e22, 0.1f + random_unit(state),
            0.1f + random_unit(state) };
    for (int i = 0; i < 9; ++i) f.fixed[i] = (double)values[i];
    for (int i = 0; i < 3; ++i) f.s[i] = (double)(size * signed_unit(state));
    return f;
}

/* The largest error, in parts of what the numbers are made of. */
static double finish_faces(uint64_t* state, float size)
{
    float fixed[9][PLIANT_LANES], plain[9][PLIANT_LANES];
    face_numbers faces[PLIANT_LANES];
    const pliant_element_group group = { NULL, fixed[0], NULL, PLIANT_LANES, NULL, 0 };
    double worst = 0.0;
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        faces[l] = random_face(state, size);
        for (int i = 0; i < 9; ++i) fixed[i][l] = (float)faces[l].fixed[i];
        for (int i = 0; i < 3; ++i) plain[4 + i][l] = (float)faces[l].s[i];
    }
    pliant_finish_face_neo_hookean(&group, NULL, plain[0]);
    for (size_t l = 0; l < PLIANT_LANES; ++l) {
        double numbers[5];
        const double* s = faces[l].s;
        const double h = (s[0] + s[2]) / 2, k = hypot((s[0] - s[2]) / 2, s[1]);
        compute_face(&faces[l], numbers);
        for (int i = 0; i < 4; ++i) CHECK(plain[i][l] == fixed[i][l], "fixed number %d", i);
        const double part = 20.0 * (exp(fabs(h) + k) * (fabs(h) + k));
        for (int i = 0; i < 5; ++i) {
            const double scale = i < 3 ? part + 1e-7 : 20.0 * exp(fabs(h)); /* what the fixed numbers' rounding leaves */
            const double error = fabs((double)plain[4 + i][l] - numbers[i]) / scale;
            if (!(error <= worst)) worst = error;
        }
        CHECK(fabs((double)plain[8][l] - numbers[4]) <= 1e-6 * numbers[4], "P");
    }
    return worst;
}

static void check_faces(void)
{
    uint64_t state = 67;
    for (int round = 0; round < 2000; ++round) {
        const float size = ldexpf(4.0f, -(int)random_below(&state, 30));
        const double error = finish_faces(&state, size);
        CHECK(error < 1e-6, "numbers of faces are off by %.3g at strains of %g", error, (double)size);
    }
}

/* W of far shapes: the form (L + P I):G + (B + r P) det G, which must not be negative for any G that is. */
static void check_lower_bound(const float plain[9][PLIANT_LANES], size_t l)
{
    const double r = (double)plain[3][l], p = (double)plain[8][l];
    const double m11 = (double)plain[4][l] + p * (double)plain[0][l], m22 = (double)plain[6][l] + p * (double)plain[2][l];
    const double m12 = 0.5 * (double)plain[5][l] + p * (double)plain[1][l];
    CHECK((double)plain[7][l] + r * p > 1e-7 * r * p, "of det G: %g beside %g", (double)plain[7][l], r * p);
    CHECK(m11 > 0.0 && m11 * m22 > m12 * m12, "of G: %g %g %g", m11, m12, m22);
}

/* What weights of 1e30 and hostile files bring: finite where the fixed numbers are sound; what is no number stays none. */
static void check_absurd_faces(void)
{
    static const float strains[] = { 0.0f, 1e-40f, 1e-20f, 16.0f, -16.0f, 1e10f, -1e10f, 1e30f, -1e30f, FLT_MAX, -FLT_MAX };
    const size_t count = sizeof strains / sizeof *strains;
    uint64_t state = 71;
    for (size_t i = 0; i < count * count * count; ++i) {
        const face_numbers f = random_face(&state, 1.0f);
        float fixed[9][PLIANT_LANES], plain[9][PLIANT_LANES];
        const pliant_element_group group = { NULL, fixed[0], NULL, PLIANT_LANES, NULL, 0 };
        for (size_t l = 0; l < PLIANT_LANES; ++l) {
            for (int j = 0; j < 9; ++j) fixed[j][l] = (float)f.fixed[j];
            plain[4][l] = strains[i % count];
            plain[5][l] = strains[i / count % count];
            plain[6][l] = strains[i / count / count];
        }
        fixed[3][1] = fixed[4][2] = fixed[6][3] = 0.0f;
        plain[4][4] = NAN;
        plain[5][5] = INFINITY;
        pliant_finish_face_neo_hookean(&group, NULL, plain[0]);
        for (int j = 0; j < 9; ++j)
            CHECK(pliant_is_finite(plain[j][0]), "number %d for strains %g %g %g", j, (double)strains[i % count],
                  (double)strains[i / count % count], (double)strains[i / count / count]);
        CHECK(isnan(plain[4][4]) && !pliant_is_finite(plain[5][5]), "what is no number has become one");
        check_lower_bound(plain, 0);
    }
}

/* ------------------------------------------------------------------------------------------------------- weights ---- */

static double distance(const pliant_asset* asset, const float* a, const float* b)
{
    const float* first = pliant_asset_pose_coordinates(asset, 0);
    const float* second = pliant_asset_pose_coordinates(asset, 1);
    double error = 0.0, size = 0.0;
    for (uint32_t j = 0; j < asset->dimension; ++j) {
        error += (double)((a[j] - b[j]) * (a[j] - b[j]));
        size += (double)((second[j] - first[j]) * (second[j] - first[j]));
    }
    return sqrt(error / size);
}

static pliant_solve_info solve_fresh(const pliant_asset* asset, const float* weights, float* q)
{
    pliant_solve_info info;
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(asset, &desc);
    CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "a new solver");
    free(made.memory);
    return info;
}

static void check_description(const opened* o)
{
    const pliant_asset* asset = &o->asset;
    const uint32_t m = asset->pose_count;
    pliant_weight weight = { NULL, 7.0f, 7.0f, 7.0f };
    CHECK(asset->weight_count == (asset->has_layers ? m - 1 : m) && asset->has_layers == (asset->layers != NULL),
          "%s: %u weights of %u poses", o->name, asset->weight_count, m);
    CHECK(asset->has_layers == (uint32_t)(strncmp(o->name, "layers", 6) == 0), "%s: layers or averages", o->name);
    for (uint32_t k = 0; k < asset->weight_count; ++k) {
        static const float ranges[3][3] = { { -1.0f, 1.0f, 0.0f }, { 0.0f, 1.5f, 0.25f }, { -0.5f, 2.0f, -0.25f } };
        const float* range = ranges[k % 3]; /* of tiny_layers.py */
        CHECK(pliant_asset_weight(asset, k, &weight) == PLIANT_OK, "%s: weight %u", o->name, k);
        CHECK(weight.name == pliant_asset_pose_name(asset, asset->has_layers ? k + 1 : k), "%s: name %u", o->name, k);
        if (asset->has_layers)
            CHECK(weight.low == range[0] && weight.high == range[1] && weight.initial == range[2], "%s: range %u", o->name,
                  k);
        else
            CHECK(weight.low == 0.0f && weight.high == 1.0f && weight.initial == 1.0f / (float)m, "%s: range %u", o->name,
                  k);
    }
    const pliant_weight before = weight;
    const pliant_asset closed = { 0 };
    CHECK(pliant_asset_weight(asset, asset->weight_count, &weight) == PLIANT_ERROR_ARGUMENT, "%s: one too many", o->name);
    CHECK(pliant_asset_weight(asset, UINT32_MAX, &weight) == PLIANT_ERROR_ARGUMENT, "%s: far too many", o->name);
    CHECK(pliant_asset_weight(NULL, 0, &weight) == PLIANT_ERROR_ARGUMENT, "no asset");
    CHECK(pliant_asset_weight(&closed, 0, &weight) == PLIANT_ERROR_ARGUMENT, "an asset that did not open");
    CHECK(pliant_asset_weight(asset, 0, NULL) == PLIANT_ERROR_ARGUMENT, "no place for the answer");
    CHECK(memcmp(&before, &weight, sizeof weight) == 0, "%s: an error changes the answer", o->name);
}

/* A layer alone at weight 1 is that pose, all at 0 are the rest shape, and 1/2 is neither: nothing is normalised. With one
   dimension a ridge lies on the straight way to the pose, and the blend ends before it. */
static void check_known_answers(const opened* o)
{
    const pliant_asset* asset = &o->asset;
    float weights[64] = { 0.0f }, q[256], half[256];
    solve_fresh(asset, weights, q);
    CHECK(distance(asset, q, pliant_asset_pose_coordinates(asset, 0)) < 2e-3, "%s: all layers at 0", o->name);
    for (uint32_t k = 0; asset->dimension > 1 && k < asset->weight_count && k < 3;
         ++k) { /* further ones are mixtures: tiny_layers.py */
        weights[k] = 1.0f;
        const pliant_solve_info info = solve_fresh(asset, weights, q);
        const double error = distance(asset, q, pliant_asset_pose_coordinates(asset, k + 1));
        CHECK(error < 2e-3, "%s: layer %u is off by %.3g, status %d", o->name, k, error, (int)info.status);
        weights[k] = 0.5f;
        solve_fresh(asset, weights, half);
        CHECK(distance(asset, half, q) > 0.05, "%s: half of layer %u", o->name, k);
        weights[k] = 0.0f;
    }
}

/* Near and far from the ranges the energy is 0 at z = 0, whatever the weights. */
static void check_energy_at_rest(const opened* o)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    pliant_solver* s = made.solver;
    uint64_t state = 73;
    for (int round = 0; round < 20; ++round) {
        double energy;
        s->weights[0] = 1.0f;
        random_blend(&state, &o->asset, s->weights + 1);
        memset(s->z, 0, o->asset.padded_dimension * sizeof(float));
        pliant_solver_combine(s);
        CHECK(pliant_solver_evaluate(s, s->z, &energy, s->gradient), "%s: z = 0", o->name);
        CHECK(fabs(energy) <= 2e-5 * (double)o->asset.energy_scale, "%s: energy %.3g at z = 0, scale %.3g", o->name, energy,
              (double)o->asset.energy_scale);
    }
    free(made.memory);
}

/* Without layers there is neither a load nor a way from the rest shape, to the bit. */
static void check_start_at_rest(const opened* o)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    pliant_solver* s = made.solver;
    memset(s->weights, 0, o->asset.pose_count * sizeof(float));
    s->weights[0] = 1.0f;
    pliant_radial_evaluate(s->kernels, &o->asset, s->weights, s->radial_scratch, s->start, s->load);
    for (uint32_t j = 0; j < o->asset.dimension; ++j)
        CHECK(s->start[j] == 0.0f && (!s->load || s->load[j] == 0.0f), "%s: start or load %u at rest", o->name, j);
    free(made.memory);
}

static void check_bad_weights(const opened* o)
{
    static const float bad[] = { NAN, -NAN, INFINITY, -INFINITY };
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    unsigned char* before = malloc(made.size);
    float weights[64], q[256] = { 0.0f }, same_q[256];
    uint64_t state = 79;
    if (!before) exit(2);
    random_blend(&state, &o->asset, weights);
    CHECK(pliant_solve(made.solver, weights, q, NULL) == PLIANT_OK, "%s", o->name);
    memcpy(before, made.memory, made.size);
    memcpy(same_q, q, sizeof q);
    for (uint32_t k = 0; k < o->asset.weight_count; ++k)
        for (size_t i = 0; i < 4; ++i) {
            pliant_solve_info info = { PLIANT_STATUS_LIMIT, 7, 7, 7.0f, 7.0f, 7.0f };
            const pliant_solve_info same = info;
            const float good = weights[k];
            weights[k] = bad[i];
            CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_ERROR_WEIGHT_NOT_FINITE, "%s: weight %u", o->name,
                  k);
            CHECK(is_same_memory(before, made.memory, made.size) && memcmp(q, same_q, sizeof q) == 0
                      && memcmp(&info, &same, sizeof info) == 0,
                  "%s: weight %u changed something", o->name, k);
            weights[k] = good;
        }
    free(before);
    free(made.memory);
}

/* Any finite weights give a finite shape, and the frame after is as from a new solver. */
static void check_any_weights(const opened* o)
{
    static const float sizes[] = { 1e30f, -1e30f, FLT_MAX, -FLT_MAX, 1e-45f, -0.0f, 3.0f, -2.0f, 100.0f, 1e8f };
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&o->asset, &desc);
    float weights[64], good[64], q[256], fresh[256];
    uint64_t state = 83;
    memset(good, 0, sizeof good);
    good[0] = 0.3f;
    solve_fresh(&o->asset, good, fresh);
    for (int round = 0; round < 200 / SLOWNESS; ++round) {
        pliant_solve_info info;
        for (uint32_t k = 0; k < o->asset.weight_count; ++k)
            weights[k] = random_below(&state, 2) ? 0.0f : sizes[random_below(&state, 10)];
        if (round < 10) weights[0] = sizes[round];
        CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s: round %d", o->name, round);
        for (uint32_t j = 0; j < o->asset.dimension; ++j) CHECK(pliant_is_finite(q[j]), "%s: q in round %d", o->name, round);
        CHECK(pliant_is_finite(info.energy) && pliant_is_finite(info.gradient) && pliant_is_finite(info.outside)
                  && info.outside >= 0.0f && info.evaluations <= desc.max_evaluations,
              "%s: info in round %d", o->name, round);
        CHECK(pliant_solve(made.solver, good, q, &info) == PLIANT_OK, "%s", o->name);
        CHECK(distance(&o->asset, q, fresh) < 5e-3, "%s: after round %d off by %.3g", o->name, round,
              distance(&o->asset, q, fresh));
    }
    free(made.memory);
}

/* The ranges of tiny_layers.py: -1 .. 1, 0 .. 1.5, -0.5 .. 2, and so on. */
static void check_outside(const opened* o)
{
    static const struct {
        float weights[3], outside;
    } cases[] = { { { 0.0f, 0.0f, 0.0f }, 0.0f },
                  { { 1.0f, 1.5f, 2.0f }, 0.0f },
                  { { -1.0f, 0.0f, -0.5f }, 0.0f },
                  { { 1.5f, 0.0f, 0.0f }, 0.25f },
                  { { -2.0f, 0.0f, 0.0f }, 0.5f },
                  { { 0.0f, -0.75f, 0.0f }, 0.5f },
                  { { 1.5f, 3.0f, 2.5f }, 1.0f },
                  { { 1.5f, 1.5f, 2.25f }, 0.25f },
                  { { 0.0f, 0.0f, -3.0f }, 1.0f },
                  { { FLT_MAX, 0.0f, 0.0f }, 0.5f * FLT_MAX },
                  { { 0.0f, -FLT_MAX, 0.0f }, FLT_MAX / 1.5f } };
    for (size_t i = 0; o->asset.weight_count >= 3 && i < sizeof cases / sizeof *cases; ++i) {
        float weights[64] = { 0.0f }, q[256];
        memcpy(weights, cases[i].weights, sizeof cases[i].weights);
        const pliant_solve_info info = solve_fresh(&o->asset, weights, q);
        CHECK(fabsf(info.outside - cases[i].outside) <= 1e-6f * cases[i].outside, "%s: case %zu is %g outside", o->name, i,
              (double)info.outside);
    }
}

static int continues(const pliant_asset* asset, const float* from, const float* to)
{
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.max_iterations = 1; /* an end that depends on the start */
    const made_solver made = make_solver(asset, &desc), other = make_solver(asset, &desc);
    float q[256], fresh[256];
    CHECK(pliant_solve(made.solver, from, q, NULL) == PLIANT_OK && pliant_solve(made.solver, to, q, NULL) == PLIANT_OK
              && pliant_solve(other.solver, to, fresh, NULL) == PLIANT_OK,
          "frames");
    free(made.memory);
    free(other.memory);
    return memcmp(q, fresh, asset->dimension * sizeof *q) != 0;
}

/* All layers may move by the continuity at once; one that moves by more makes a jump. */
static void check_continuity(const opened* o)
{
    float from[64] = { 0.0f }, all[64] = { 0.0f }, one[64] = { 0.0f };
    for (uint32_t k = 0; k < o->asset.weight_count; ++k) {
        from[k] = k < 3 ? 0.3f : 0.0f;
        all[k] = from[k] + (k % 2 ? -0.09f : 0.09f);
        one[k] = from[k] + (k == o->asset.weight_count - 1 ? 0.11f : 0.0f);
    }
    CHECK(continues(&o->asset, from, all), "%s: a jump though no layer moves by more than 0.09", o->name);
    CHECK(!continues(&o->asset, from, one), "%s: no jump though a layer moves by 0.11", o->name);
}

/* --------------------------------------------------------------------------------------------------------- turns ---- */

/* Makes layer 0 turn every hinge that it reaches by 2 pi, and change no other element. */
static void turn_hinges(blob_file blob, const pliant_asset* asset)
{
    unsigned char* elements = blob.data + (asset->elements - asset->blob);
    for (uint32_t i = 0; i < asset->batch_count; ++i) {
        const pliant_format_batch* batch = (const pliant_format_batch*)asset->batches + i;
        const pliant_format_shape shape = pliant_format_batch_shape(batch->kind, batch->valence, batch->is_closed);
        const size_t count = shape.pose_number_count * (size_t)PLIANT_LANES;
        const unsigned char* records = asset->elements + batch->changes_offset;
        unsigned char* change = elements + batch->changes_offset + pliant_format_change_floats_offset(batch->change_count);
        const float value = batch->kind == PLIANT_ELEMENT_LAYERED_HINGE ? 6.28318531f : 0.0f;
        for (uint32_t r = 0; r < batch->change_count; ++r, change += count * sizeof(float)) {
            if (((const pliant_format_change*)(const void*)records)[r].layer != 0) continue;
            for (size_t l = 0; l < count; ++l) memcpy(change + l * sizeof value, &value, sizeof value);
            turned_count += value != 0.0f;
        }
    }
}

/* A rest angle that is any number of turns further is the same. */
static void check_turns(const opened* o)
{
    blob_file blob = make_blob(o->blob.data, o->blob.size);
    pliant_asset asset;
    turn_hinges(blob, &o->asset);
    CHECK(pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_DEFAULT) == PLIANT_OK, "%s: turned", o->name);
    asset.load_coefficients = NULL; /* it knows of no turns */
    const pliant_solver_desc desc = pliant_solver_desc_default();
    const made_solver made = make_solver(&asset, &desc);
    pliant_solver* s = made.solver;
    uint64_t state = 89;
    double first = 0.0;
    const float size = 0.2f * sqrtf(asset.energy_scale);
    for (uint32_t j = 0; j < asset.dimension; ++j) s->z[j] = size * signed_unit(&state);
    for (int turns = 0; turns <= 12; ++turns) {
        double energy;
        s->weights[0] = 1.0f;
        s->weights[1] = (float)(turns % 2 ? -turns : turns);
        for (uint32_t k = 2; k < asset.pose_count; ++k) s->weights[k] = k < 4 ? 0.2f : 0.0f;
        pliant_solver_combine(s);
        CHECK(pliant_solver_evaluate(s, s->z, &energy, s->gradient), "%s: %d turns", o->name, turns);
        if (turns == 0) first = energy;
        CHECK(fabs(energy - first) <= 1e-4 * (double)asset.energy_scale, "%s: %d turns: energy %.9g, without %.9g", o->name,
              turns, energy, first);
    }
    free(made.memory);
    free_blob(blob);
}

static void check_asset(const opened* o)
{
    check_description(o);
    if (!o->asset.has_layers) {
        float weights[64], q[256];
        uint64_t state = 97;
        random_blend(&state, &o->asset, weights);
        CHECK(solve_fresh(&o->asset, weights, q).outside == 0.0f, "%s: averages are never outside", o->name);
        return;
    }
    ++layered_count;
    check_known_answers(o);
    check_energy_at_rest(o);
    check_start_at_rest(o);
    check_bad_weights(o);
    check_any_weights(o);
    check_outside(o);
    check_continuity(o);
    check_turns(o);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    check_hinge_example();
    check_faces();
    check_absurd_faces();
    for_each_asset(argv[1], check_asset);
    CHECK(layered_count >= 5 && turned_count > 0, "%d assets of layers, %d groups of turned hinges", layered_count,
          turned_count);
    return report("layers");
}
