/* The runtime against the numpy reference: energy, gradient, blends, predictor. And the gradient against differences of the
   energy, which does not trust the reference. Argument: the folder of make_test_assets.py. */
#include "internal.h"
#include "linalg.h"
#include "support.h"

#include <math.h>

static const char* folder;
static int uphill_count; /* predictions above the energy of z = 0 */

/* The evaluator under test: elements and load, as a solver sees them. */
typedef struct evaluator {
    made_solver made;
    float* weights;
    float* z;
    float* gradient;
} evaluator;

static evaluator make_evaluator(const pliant_asset* asset)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    evaluator e;
    e.made = make_solver(asset, &desc);
    e.weights = e.made.solver->weights;
    e.z = e.made.solver->z;
    e.gradient = e.made.solver->gradient;
    return e;
}

static double evaluate(evaluator* e)
{
    pliant_solver* s = e->made.solver;
    double energy = 0.0;
    pliant_solver_combine(s);
    pliant_radial_evaluate(s->kernels, &s->asset, s->weights, s->radial_scratch, s->start, s->load);
    CHECK(pliant_solver_evaluate(s, s->z, &energy, s->gradient), "not finite");
    return energy;
}

static int read_numbers(FILE* file, float* numbers, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        double value;
        if (fscanf(file, "%lf", &value) != 1) return 0;
        numbers[i] = (float)value;
    }
    return 1;
}

/* Units: energies in energy_scale, gradients in sqrt(energy_scale), as z is whitened. */
static void check_evaluation(const opened* o, FILE* file)
{
    evaluator e = make_evaluator(&o->asset);
    const uint32_t d = o->asset.dimension;
    const double scale = (double)o->asset.energy_scale;
    double energy, expected, error = 0.0, size = 0.0;
    CHECK(read_numbers(file, e.weights, o->asset.pose_count) && read_numbers(file, e.z, d), "%s: bad line", o->name);
    energy = evaluate(&e);
    CHECK(fscanf(file, "%lf", &expected) == 1, "%s: bad line", o->name);
    CHECK(fabs(energy - expected) <= 1e-5 * (fabs(expected) + scale), "%s: energy %.9g, reference %.9g", o->name, energy,
          expected);
    for (uint32_t j = 0; j < d; ++j) {
        CHECK(fscanf(file, "%lf", &expected) == 1, "%s: bad line", o->name);
        error += (expected - (double)e.gradient[j]) * (expected - (double)e.gradient[j]);
        size += expected * expected;
    }
    CHECK(sqrt(error) <= 1e-5 * (sqrt(size) + sqrt(scale)), "%s: gradient off by %.3g of %.3g (scale %.3g)", o->name,
          sqrt(error), sqrt(size), sqrt(scale));
    for (uint32_t j = d; j < o->asset.padded_dimension; ++j) CHECK(e.gradient[j] == 0.0f, "%s: padding", o->name);
    free(e.made.memory);
}

/* A blend from a new solver. The distance is measured against the distance between poses. */
static void check_solve(const opened* o, FILE* file)
{
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.tolerance = 1e-4f;
    const made_solver made = make_solver(&o->asset, &desc);
    const uint32_t d = o->asset.dimension, m = o->asset.weight_count;
    float weights[PLIANT_FORMAT_MAX_POSES], q[PLIANT_FORMAT_MAX_DIMENSION];
    pliant_solve_info info;
    double error = 0.0, size = 0.0;
    CHECK(read_numbers(file, weights, m), "%s: bad line", o->name);
    CHECK(pliant_solve(made.solver, weights, q, &info) == PLIANT_OK, "%s", o->name);
    const float* first = pliant_asset_pose_coordinates(&o->asset, 0);
    const float* second = pliant_asset_pose_coordinates(&o->asset, 1);
    for (uint32_t j = 0; j < d; ++j) {
        double expected;
        CHECK(fscanf(file, "%lf", &expected) == 1, "%s: bad line", o->name);
        error += (expected - (double)q[j]) * (expected - (double)q[j]);
        size += (double)((second[j] - first[j]) * (second[j] - first[j]));
    }
    CHECK(sqrt(error / size) <= 1e-4, "%s: blend off by %.3g (status %d, %u iterations, gradient %.3g)", o->name,
          sqrt(error / size), (int)info.status, info.iterations, (double)info.gradient);
    CHECK(info.status != PLIANT_STATUS_LIMIT, "%s: iteration limit", o->name);
    free(made.memory);
}

/* Central differences along random directions. The step balances rounding (1e-7 / h) against curvature (h^2). */
static void check_gradient(const opened* o)
{
    evaluator e = make_evaluator(&o->asset);
    const uint32_t d = o->asset.dimension;
    const float scale = sqrtf(o->asset.energy_scale), step = 0.02f * scale;
    uint64_t state = 11;
    float start[PLIANT_FORMAT_MAX_DIMENSION], direction[PLIANT_FORMAT_MAX_DIMENSION];
    for (int round = 0; round < 20; ++round) {
        float sum = 0.0f;
        e.weights[0] = 1.0f;
        random_blend(&state, &o->asset, e.weights + o->asset.has_layers);
        for (uint32_t k = 0; k < o->asset.pose_count; ++k) sum += e.weights[k];
        for (uint32_t k = 0; k < o->asset.pose_count && !o->asset.has_layers; ++k) e.weights[k] /= sum;
        for (uint32_t j = 0; j < d; ++j) {
            start[j] = 0.2f * scale * (random_unit(&state) - 0.5f);
            direction[j] = (random_unit(&state) - 0.5f) / sqrtf((float)d);
        }
        double slope = 0.0, size = 0.0;
        memcpy(e.z, start, d * sizeof(float));
        evaluate(&e);
        for (uint32_t j = 0; j < d; ++j) {
            slope += (double)(e.gradient[j] * direction[j]);
            size += (double)(e.gradient[j] * e.gradient[j]);
        }
        for (uint32_t j = 0; j < d; ++j) e.z[j] = start[j] + step * direction[j];
        const double ahead = evaluate(&e);
        for (uint32_t j = 0; j < d; ++j) e.z[j] = start[j] - step * direction[j];
        const double measured = (ahead - evaluate(&e)) / (2.0 * (double)step);
        CHECK(fabs(measured - slope) <= 2e-3 * (sqrt(size) + (double)scale), "%s: slope %.6g, differences say %.6g", o->name,
              slope, measured);
    }
    free(e.made.memory);
}

/* The numbers of the surrogate energy are combined when the weights have changed, by however little, and only then; the past
   has no part in them. */
static void check_combination(const opened* o)
{
    const float mark = 12345.0f;
    if (strstr(o->name, "arap") && !o->asset.has_layers) return; /* has no such numbers */
    evaluator e = make_evaluator(&o->asset);
    evaluator other = make_evaluator(&o->asset);
    pliant_solver* s = e.made.solver;
    uint64_t state = 13;
    e.weights[0] = 1.0f;
    random_blend(&state, &o->asset, e.weights + o->asset.has_layers);
    pliant_solver_combine(s);
    const float first = s->combined[1];
    s->combined[1] = mark;
    pliant_solver_combine(s);
    pliant_solver_reset(s);
    pliant_solver_combine(s);
    CHECK(s->combined[1] == mark, "%s: combined again for the same weights", o->name);
    s->combined[1] = first;
    e.weights[o->asset.pose_count - 1] = nextafterf(e.weights[o->asset.pose_count - 1], 1.0f);
    memcpy(other.weights, e.weights, o->asset.pose_count * sizeof(float));
    s->combined[2] = mark;
    const double energy = evaluate(&e);
    CHECK(energy == evaluate(&other) && memcmp(e.gradient, other.gradient, o->asset.padded_dimension * sizeof(float)) == 0
              && s->combined[2] != mark,
          "%s: not combined again for other weights", o->name);
    free(e.made.memory);
    free(other.made.memory);
}

/* Without iterations the answer is the predictor's, whatever its energy and wherever the last frame was. */
static void check_predict(const opened* o, FILE* file, pliant_solver* solver)
{
    const uint32_t d = o->asset.dimension, m = o->asset.weight_count;
    float weights[PLIANT_FORMAT_MAX_POSES], q[PLIANT_FORMAT_MAX_DIMENSION];
    pliant_solve_info info;
    double error = 0.0, size = 0.0;
    CHECK(read_numbers(file, weights, m), "%s: bad line", o->name);
    CHECK(pliant_solve(solver, weights, q, &info) == PLIANT_OK, "%s", o->name);
    CHECK(info.iterations == 0 && info.evaluations <= 2, "%s: %u iterations, %u evaluations", o->name, info.iterations,
          info.evaluations);
    CHECK(info.status == (info.gradient <= solver->desc.tolerance ? PLIANT_STATUS_CONVERGED : PLIANT_STATUS_LIMIT),
          "%s: status %d", o->name, (int)info.status);
    uphill_count += info.energy > 0.0f;
    const float* first = pliant_asset_pose_coordinates(&o->asset, 0);
    const float* second = pliant_asset_pose_coordinates(&o->asset, 1);
    for (uint32_t j = 0; j < d; ++j) {
        double expected;
        CHECK(fscanf(file, "%lf", &expected) == 1, "%s: bad line", o->name);
        error += (expected - (double)q[j]) * (expected - (double)q[j]);
        size += (double)((second[j] - first[j]) * (second[j] - first[j]));
    }
    CHECK(sqrt(error / size) < 1e-5, "%s: the predictor is off by %.3g", o->name, sqrt(error / size));
}

/* Normals of a shape, against those of the reference: the bound is some roundings of single precision. */
static void check_normals(const opened* o, FILE* file)
{
    const uint32_t n = o->asset.vertex_count;
    float q[PLIANT_FORMAT_MAX_DIMENSION];
    pliant_normals normals;
    float* positions = malloc((size_t)n * 24);
    const size_t size = pliant_normals_memory(&o->asset);
    void* memory = malloc(size);
    if (!positions || !memory) exit(2);
    float* found = positions + 3 * (size_t)n;
    CHECK(read_numbers(file, q, o->asset.dimension), "%s: bad line", o->name);
    CHECK(pliant_normals_init(&normals, &o->asset, memory, size) == PLIANT_OK, "%s: adjacency", o->name);
    pliant_reconstruct(&o->asset, q, 0, n, positions, 12);
    pliant_normals_compute(&normals, positions, 12, 0, n, found, 12);
    for (uint32_t v = 0; v < o->asset.boundary_vertex_count; ++v) {
        double error = 0.0;
        for (int c = 0; c < 3; ++c) {
            double expected;
            CHECK(fscanf(file, "%lf", &expected) == 1, "%s: bad line", o->name);
            expected -= (double)found[3 * v + (uint32_t)c];
            error += expected * expected;
        }
        CHECK(sqrt(error) < 3e-5, "%s: normal %u is off by %.3g", o->name, v, sqrt(error));
    }
    free(memory);
    free(positions);
}

static void check_against_reference(const opened* o)
{
    char path[1024], what[16];
    int evaluations = 0, solves = 0, predictions = 0, shapes = 0;
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.max_iterations = 0;
    desc.continuity = 2.0f; /* any weights count as near: still the predictor answers */
    const made_solver predictor = make_solver(&o->asset, &desc);
    snprintf(path, sizeof path, "%s/%s.expect", folder, o->name);
    FILE* file = fopen(path, "r");
    CHECK(file != NULL, "no %s", path);
    while (file && fscanf(file, "%15s", what) == 1) {
        if (strcmp(what, "evaluate") == 0) {
            check_evaluation(o, file);
            ++evaluations;
        } else if (strcmp(what, "solve") == 0) {
            check_solve(o, file);
            ++solves;
        } else if (strcmp(what, "normals") == 0) {
            check_normals(o, file);
            ++shapes;
        } else {
            check_predict(o, file, predictor.solver);
            ++predictions;
        }
    }
    CHECK(evaluations >= 6 && solves >= 5 && predictions >= 5 && shapes >= 2,
          "%s: only %d evaluations, %d blends, %d predictions, %d shapes", path, evaluations, solves, predictions, shapes);
    free(predictor.memory);
    if (file) fclose(file);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    folder = argv[1];
    for_each_asset(folder, check_against_reference);
    for_each_asset(folder, check_gradient);
    for_each_asset(folder, check_combination);
    CHECK(uphill_count > 0, "no predictor with a positive energy: that it is kept is not tested");
    return report("reference");
}
