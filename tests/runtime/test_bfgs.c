/* What BFGS may learn: an update whose curvature is negative, or positive but below what single precision can tell from
   none, leaves the matrix alone. On one St. Venant-Kirchhoff face, whose energy is a polynomial that can be given any
   curvature; looked at from inside. */
#include "internal.h"
#include "support.h"

#include <math.h>

enum { D = 2, PADDED = 16, POSES = 2, LANES = 16, ROWS = 6, NUMBERS = 9 };

/* Places in the numbers of a face, formats/SPEC.md section 4, kind 3. */
enum { L11 = 0, L22 = 2, Q00 = 3, Q02 = 5 };

/* An asset in pieces: what a solver reads of one. */
typedef struct face {
    pliant_asset asset;
    pliant_format_batch batch;
    struct {
        float rows[1 + D][ROWS][LANES];
        float numbers[POSES][NUMBERS][LANES];
    } elements;
    float mean[PADDED];
    float whitening[D][PADDED];
    float pose_coordinates[POSES][PADDED];
    float centres[1][POSES];
    float start[1 + POSES][PADDED];
    float load[1 + POSES][PADDED];
} face;

/* Edge vectors e = (x0 + z0, 0, 0) and a = (0, 1, 0) + z1 * direction; the poses agree, so that weights do not matter. */
static void make_face(face* f, float x0, const float direction[3])
{
    memset(f, 0, sizeof *f);
    f->batch.kind = PLIANT_ELEMENT_FACE_STVK;
    f->batch.element_count = 1;
    f->batch.pose_offset = sizeof f->elements.rows;
    for (size_t l = 0; l < LANES; ++l) {
        f->elements.rows[0][0][l] = x0;
        f->elements.rows[0][4][l] = 1.0f;
        f->elements.rows[1][0][l] = 1.0f;
        for (size_t c = 0; c < 3; ++c) f->elements.rows[2][3 + c][l] = direction[c];
    }
    f->whitening[0][0] = f->whitening[1][1] = 1.0f;
    f->centres[0][0] = f->centres[0][1] = 0.5f;
    f->asset.dimension = D;
    f->asset.padded_dimension = PADDED;
    f->asset.kernels = pliant_kernels_choose();
    f->asset.pose_count = f->asset.weight_count = POSES;
    f->asset.energy_scale = 1.0f;
    f->asset.blob = (const unsigned char*)f; /* only has to be there */
    f->asset.mean = f->mean;
    f->asset.whitening = f->whitening[0];
    f->asset.pose_coordinates = f->pose_coordinates[0];
    f->asset.batches = &f->batch;
    f->asset.batch_count = 1;
    f->asset.elements = (const unsigned char*)&f->elements;
    f->asset.predictor_centres = f->centres[0];
    f->asset.predictor_coefficients = f->start[0];
    f->asset.predictor_count = 1;
    f->asset.load_coefficients = f->load[0];
}

static void set_number(face* f, int place, float value)
{
    for (size_t k = 0; k < POSES; ++k) f->elements.numbers[k][place][0] = value; /* the other lanes are padding */
}

static pliant_solve_info solve(const face* f, uint32_t max_iterations, made_solver* made, float* q)
{
    static const float weights[POSES] = { 1.0f, 1.0f };
    pliant_solver_desc desc = pliant_solver_desc_default();
    pliant_solve_info info = { PLIANT_STATUS_STALLED, 0, 0, 0.0f, 0.0f, 0.0f };
    desc.max_iterations = max_iterations;
    *made = make_solver(&f->asset, &desc);
    CHECK(pliant_solve(made->solver, weights, q, &info) == PLIANT_OK, "a frame");
    return info;
}

static int is_identity(const pliant_solver* solver)
{
    for (size_t i = 0; i < D; ++i)
        for (size_t j = 0; j < PADDED; ++j)
            if (solver->inverse_hessian[i * PADDED + j] != (i == j ? 1.0f : 0.0f)) return 0;
    return solver->is_identity;
}

/* f = -(x^2 - x0^2) + (x^2 - x0^2)^2 / 2 + z1^2 / 2 at x = x0 + z0: concave around x = 0, lowest at x^2 = 1 + x0^2. */
static void check_way_through_concave(void)
{
    static const float across[3] = { 0.0f, 0.0f, 1.0f };
    const float x0 = 0.1f;
    face f;
    made_solver made;
    float q[D];
    make_face(&f, x0, across);
    set_number(&f, L11, -1.0f);
    set_number(&f, L22, 0.5f);
    set_number(&f, Q00, 1.0f);
    const pliant_solve_info info = solve(&f, 60, &made, q);
    CHECK(info.status == PLIANT_STATUS_CONVERGED && fabsf(q[0] + x0 - sqrtf(1.0f + x0 * x0)) < 1e-3f, "status %d at %.9g",
          (int)info.status, (double)q[0]);
    free(made.memory);
}

/* E = Q00 g11^2 / 2 + Q02 g11 g22 - 0.01 z0 with g11 = 2 z0 + z0^2, g22 = 2 z1 + z1^2. The first step goes along z0, where
   the curvature is about 4 Q00, and turns the gradient by about 4 Q02 times its length towards z1. */
static int learns(float q00)
{
    static const float along[3] = { 0.0f, 1.0f, 0.0f };
    face f;
    made_solver made;
    float q[D];
    make_face(&f, 1.0f, along);
    set_number(&f, Q00, q00);
    set_number(&f, Q02, 0.25f);
    for (size_t k = 0; k < POSES; ++k) f.load[1 + k][0] = -0.01f;
    const pliant_solve_info info = solve(&f, 1, &made, q);
    CHECK(info.iterations == 1 && fabsf(q[0] - 0.01f) < 1e-7f && q[1] == 0.0f, "not the step that is meant: %u, to %.9g",
          info.iterations, (double)q[0]);
    const int has_learned = !is_identity(made.solver);
    free(made.memory);
    return has_learned;
}

int main(void)
{
    check_way_through_concave();
    /* s.y over |s||y| is about 4 Q00; the floor is 1e-3. */
    CHECK(learns(2.5e-2f), "a curvature of 0.1 was not learned");
    CHECK(learns(1e-3f), "a curvature of 4 times the floor was not learned");
    CHECK(!learns(7e-5f), "a curvature below the floor was learned");
    CHECK(!learns(0.0f), "no curvature was learned");
    CHECK(!learns(-1e-3f), "a small negative curvature was learned");
    CHECK(!learns(-2.5e-2f), "a negative curvature was learned");
    return report("bfgs");
}
