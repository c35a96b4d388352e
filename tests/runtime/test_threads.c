/* One asset, two threads, a solver each: the answers are those of one thread. ThreadSanitizer finds here what is shared. */
#include "support.h"

#include <pthread.h>

typedef struct job {
    const opened* o;
    pliant_solver* solver;
    float q[40][256];
} job;

static void* work(void* argument)
{
    job* j = (job*)argument;
    for (int frame = 0; frame < 40; ++frame) {
        float weights[64], positions[48];
        const float unit = j->o->asset.has_layers ? 0.05f : 1.0f;
        for (uint32_t k = 0; k < j->o->asset.weight_count; ++k)
            weights[k] = unit * (1.0f + (float)((frame * (int)(k + 1)) % 7));
        if (pliant_solve(j->solver, weights, j->q[frame], NULL) != PLIANT_OK) return NULL;
        pliant_reconstruct(&j->o->asset, j->q[frame], 0, 16, positions, 12);
    }
    return argument;
}

static void check_two_threads(const opened* o)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    static job jobs[3];
    made_solver made[3];
    pthread_t threads[2];
    for (int i = 0; i < 3; ++i) {
        made[i] = make_solver(&o->asset, &desc);
        memset(&jobs[i], 0, sizeof jobs[i]);
        jobs[i].o = o;
        jobs[i].solver = made[i].solver;
    }
    for (int i = 0; i < 2; ++i) CHECK(pthread_create(&threads[i], NULL, work, &jobs[i]) == 0, "thread %d", i);
    for (int i = 0; i < 2; ++i) {
        void* answer = NULL;
        CHECK(pthread_join(threads[i], &answer) == 0 && answer, "%s: thread %d failed", o->name, i);
    }
    CHECK(work(&jobs[2]) != NULL, "%s", o->name);
    for (int i = 0; i < 2; ++i) CHECK(memcmp(jobs[i].q, jobs[2].q, sizeof jobs[2].q) == 0, "%s: thread %d", o->name, i);
    for (int i = 0; i < 3; ++i) free(made[i].memory);
}

int main(int argc, char** argv)
{
    if (argc != 2) return 2;
    for_each_asset(argv[1], check_two_threads);
    return report("threads");
}
