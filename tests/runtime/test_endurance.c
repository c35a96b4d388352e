/* test_endurance FOLDER [FRAMES [ASSET.pliant...]]: for every asset 64 characters on 4 threads solve FRAMES frames in all:
   drags, jumps, weights that stay, extreme ones, resets, and bursts of invalid weights. No call of the allocator, no
   position or normal that is not finite, no trace of an invalid call, and at the end the bits of new solvers: each character
   has those of one that saw only its valid frames since its last reset. FOLDER may be "-" where assets are named. Linked
   with --wrap. The whole: runtime_endurance FOLDER 1000000. */
#include "allocations.h"
#include "support.h"

#include <float.h>
#include <math.h>
#include <pthread.h>

enum { THREADS = 4, CHARACTERS = 64, OF_THREAD = CHARACTERS / THREADS };

static long frames_for_each = 4000 / SLOWNESS;

typedef struct history {
    uint64_t state; /* of the random numbers */
    float weights[64];
    long frames; /* valid ones */
} history;

typedef struct character {
    made_solver made;
    history now, at_reset;
    float q[256];
    pliant_solve_info info;
} character;

typedef struct team {
    const opened* o;
    const pliant_normals* normals;
    character characters[OF_THREAD];
    float* vertices; /* positions and normals of one character */
    long frames, not_finite, wrong_answers, traces;
} team;

/* Weights that no blend has. */
static void make_invalid(uint64_t* state, const pliant_asset* asset, float* weights)
{
    random_blend(state, asset, weights);
    const uint32_t k = random_below(state, asset->weight_count);
    switch (random_below(state, asset->has_layers ? 3 : 5)) {
    case 0: weights[k] = NAN; break;
    case 1: weights[k] = INFINITY; break;
    case 2: weights[k] = -INFINITY; break;
    case 3: weights[k] = -FLT_MIN; break;
    default: memset(weights, 0, asset->weight_count * sizeof *weights);
    }
}

/* The character keeps its bits, whatever it is given. */
static void burst(team* t, character* c, uint64_t state)
{
    const long count = 1 + random_below(&state, 8);
    for (long i = 0; i < count; ++i) {
        float weights[64], q[256];
        pliant_solve_info info = c->info;
        make_invalid(&state, &t->o->asset, weights);
        memcpy(q, c->q, sizeof q);
        t->wrong_answers += pliant_solve(c->made.solver, weights, q, &info) == PLIANT_OK;
        t->traces += memcmp(q, c->q, sizeof q) != 0 || memcmp(&info, &c->info, sizeof info) != 0;
    }
}

static void extreme(uint64_t* state, const pliant_asset* asset, float* weights)
{
    static const float scales[] = { 1e-42f, 1e-30f, 1e12f, 1e30f };
    const float scale = scales[random_below(state, 4)];
    random_blend(state, asset, weights);
    for (uint32_t k = 0; k < asset->weight_count; ++k) weights[k] *= scale;
}

static void drag(uint64_t* state, const pliant_asset* asset, float* weights)
{
    for (uint32_t k = 0; k < asset->weight_count; ++k) {
        weights[k] += 0.02f * (random_unit(state) - 0.5f);
        if (weights[k] < 0.0f && !asset->has_layers) weights[k] = 0.0f;
    }
    weights[0] += 1e-6f;
}

/* One valid frame. Without `t` no invalid calls before it: a character that only repeats the history of another. */
static void act(team* t, const pliant_asset* asset, character* c, uint32_t action)
{
    history* h = &c->now;
    if (action >= 95) {
        const uint64_t state = random_bits(&h->state);
        if (t) burst(t, c, state);
    }
    if (action < 15 || action >= 97)
        random_blend(&h->state, asset, h->weights);
    else if (action < 17)
        extreme(&h->state, asset, h->weights);
    else if (action < 90)
        drag(&h->state, asset, h->weights);
    const pliant_result result = pliant_solve(c->made.solver, h->weights, c->q, &c->info);
    if (t) t->wrong_answers += result != PLIANT_OK;
    ++h->frames;
}

static void start(character* c)
{
    pliant_solver_reset(c->made.solver);
    c->now.frames = 0;
    c->at_reset = c->now;
}

static void step(team* t, const pliant_asset* asset, character* c)
{
    const uint32_t action = random_below(&c->now.state, 100);
    if (action < 3) start(c);
    act(t, asset, c, action);
}

static void check_vertices(team* t, const character* c)
{
    const pliant_asset* asset = &t->o->asset;
    float* normals = t->vertices + 3 * (size_t)asset->vertex_count;
    pliant_reconstruct(asset, c->q, 0, asset->vertex_count, t->vertices, 12);
    pliant_normals_compute(t->normals, t->vertices, 12, 0, asset->boundary_vertex_count, normals, 12);
    const size_t count = 3 * ((size_t)asset->vertex_count + asset->boundary_vertex_count);
    for (size_t i = 0; i < count; ++i) t->not_finite += t->vertices[i] - t->vertices[i] != 0.0f;
}

static void* work(void* argument)
{
    team* t = argument;
    for (int i = 0; i < OF_THREAD; ++i) {
        start(&t->characters[i]);
        act(t, &t->o->asset, &t->characters[i], 0);
        check_vertices(t, &t->characters[i]);
    }
    for (long frame = OF_THREAD; frame < t->frames; ++frame) {
        character* c = &t->characters[frame % OF_THREAD];
        step(t, &t->o->asset, c);
        check_vertices(t, c);
    }
    return NULL;
}

/* What the character did since its last reset, by a new solver and without the invalid calls. */
static int new_solver_agrees(const pliant_asset* asset, const character* c)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    character other = { .made = make_solver(asset, &desc), .now = c->at_reset };
    act(NULL, asset, &other, 0);
    while (other.now.frames < c->now.frames) step(NULL, asset, &other);
    free(other.made.memory);
    return memcmp(other.q, c->q, asset->dimension * sizeof(float)) == 0
        && memcmp(&other.info, &c->info, sizeof c->info) == 0;
}

static void run_teams(const opened* o, team* teams)
{
    pthread_t threads[THREADS];
    const long before = allocation_count;
    for (int i = 0; i < THREADS; ++i) CHECK(pthread_create(&threads[i], NULL, work, &teams[i]) == 0, "thread %d", i);
    for (int i = 0; i < THREADS; ++i) CHECK(pthread_join(threads[i], NULL) == 0, "thread %d", i);
    const long allocations = allocation_count - before;
    CHECK(allocations == 0, "%s: %ld calls of the allocator", o->name, allocations);
    for (int i = 0; i < THREADS; ++i) {
        const team* t = &teams[i];
        CHECK(t->not_finite == 0, "%s: %ld numbers of vertices are not finite", o->name, t->not_finite);
        CHECK(t->wrong_answers == 0, "%s: %ld calls with the wrong answer", o->name, t->wrong_answers);
        CHECK(t->traces == 0, "%s: %ld invalid calls changed q or info", o->name, t->traces);
        for (int k = 0; k < OF_THREAD; ++k)
            CHECK(new_solver_agrees(&o->asset, &t->characters[k]), "%s: thread %d, character %d, %ld frames after a reset",
                  o->name, i, k, t->characters[k].now.frames);
    }
}

/* The gate's slice: ARAP costs a hundred times a hinge. */
static int is_slow(const opened* o) { return strstr(o->name, "arap") || strstr(o->name, "mixed"); }

static void check_asset(const opened* o)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    static team teams[THREADS];
    const size_t size = pliant_normals_memory(&o->asset);
    pliant_normals normals;
    void* memory = malloc(size);
    const long frames = frames_for_each <= 4000 && is_slow(o) ? frames_for_each / 10 : frames_for_each;
    if (!memory || pliant_normals_init(&normals, &o->asset, memory, size) != PLIANT_OK) exit(2);
    memset(teams, 0, sizeof teams);
    for (int i = 0; i < THREADS; ++i) {
        teams[i].o = o;
        teams[i].normals = &normals;
        teams[i].frames = frames / THREADS;
        teams[i].vertices = malloc(6 * sizeof(float) * (size_t)o->asset.vertex_count);
        if (!teams[i].vertices) exit(2);
        for (int k = 0; k < OF_THREAD; ++k) {
            teams[i].characters[k].made = make_solver(&o->asset, &desc);
            teams[i].characters[k].now.state = (uint64_t)(61 + OF_THREAD * i + k);
        }
    }
    run_teams(o, teams);
    printf("%s: %ld frames\n", o->name, frames);
    for (int i = 0; i < THREADS; ++i) {
        free(teams[i].vertices);
        for (int k = 0; k < OF_THREAD; ++k) free(teams[i].characters[k].made.memory);
    }
    free(memory);
}

static void check_file(const char* path)
{
    opened o = { .blob = read_blob(path) };
    snprintf(o.name, sizeof o.name, "%s", strrchr(path, '/') ? strrchr(path, '/') + 1 : path);
    const pliant_result result = pliant_asset_open(&o.asset, o.blob.data, o.blob.size, PLIANT_OPEN_VERIFY_CHECKSUMS);
    CHECK(result == PLIANT_OK, "%s: %s", path, pliant_result_text(result));
    if (result == PLIANT_OK) check_asset(&o);
    free_blob(o.blob);
}

int main(int argc, char** argv)
{
    if (argc < 2) return 2;
    if (argc > 2) frames_for_each = strtol(argv[2], NULL, 10);
    if (frames_for_each < CHARACTERS) return 2;
    if (strcmp(argv[1], "-") != 0) for_each_asset(argv[1], check_asset);
    for (int i = 3; i < argc; ++i) check_file(argv[i]);
    CHECK(allocation_count > 0, "the wrapper counts nothing: this test is not linked as it should be");
    return report("endurance");
}
