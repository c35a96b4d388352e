/* What the runtime's tests share: checks that count, files in memory of chosen alignment, random numbers. */
#ifndef PLIANT_TEST_SUPPORT_H
#define PLIANT_TEST_SUPPORT_H

#include "pliant.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__has_feature) /* clang; gcc has macros */
#if __has_feature(memory_sanitizer)
#define NOT_FOR_MEMORY_SANITIZER __attribute__((no_sanitize("memory"), noinline))
#endif
#endif

/* Tests that only repeat themselves do so less often where every access is checked. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(NOT_FOR_MEMORY_SANITIZER)
#define SLOWNESS 10
#else
#define SLOWNESS 1
#endif

static int failure_count;

/* Reports and goes on; at most 20 lines, so that a broken build does not drown its first message. */
#define CHECK(condition, ...)                                               \
    do {                                                                    \
        if (!(condition) && ++failure_count <= 20) {                        \
            fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition); \
            fprintf(stderr, __VA_ARGS__);                                   \
            fputc('\n', stderr);                                            \
        }                                                                   \
    } while (0)

static inline int report(const char* test)
{
    if (failure_count)
        fprintf(stderr, "%s: %d checks failed\n", test, failure_count);
    else
        printf("%s: passed\n", test);
    return failure_count ? 1 : 0;
}

#ifndef NOT_FOR_MEMORY_SANITIZER
#define NOT_FOR_MEMORY_SANITIZER
#endif

/* memcmp() == 0 for the memory of a solver, of which not all is ever written. */
NOT_FOR_MEMORY_SANITIZER
static inline int is_same_memory(const void* a, const void* b, size_t size)
{
    const unsigned char *const left = (const unsigned char*)a, *const right = (const unsigned char*)b;
    for (size_t i = 0; i < size; ++i)
        if (left[i] != right[i]) return 0;
    return 1;
}

/* xorshift64*: the same numbers everywhere. */
static inline uint64_t random_bits(uint64_t* state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 2685821657736338717ull;
}

static inline uint32_t random_below(uint64_t* state, uint32_t limit)
{
    return (uint32_t)((random_bits(state) >> 32) % limit);
}

static inline float random_unit(uint64_t* state) { return (float)(random_bits(state) >> 40) / 16777216.0f; }

/* A file in memory aligned to 64; the process ends if it cannot be read. Freed by free_blob. */
typedef struct blob_file {
    unsigned char* data;
    size_t size;
    void* block;
} blob_file;

static inline blob_file make_blob(const void* bytes, size_t size)
{
    blob_file blob = { NULL, size, malloc(size + 64) };
    if (!blob.block) exit(2);
    blob.data = (unsigned char*)blob.block + (64 - (uintptr_t)blob.block % 64) % 64;
    if (bytes) memcpy(blob.data, bytes, size);
    return blob;
}

static inline blob_file read_blob(const char* path)
{
    FILE* file = fopen(path, "rb");
    long size;
    if (!file || fseek(file, 0, SEEK_END) != 0 || (size = ftell(file)) < 0 || fseek(file, 0, SEEK_SET) != 0) {
        fprintf(stderr, "cannot read %s\n", path);
        exit(2);
    }
    blob_file blob = make_blob(NULL, (size_t)size);
    if (fread(blob.data, 1, blob.size, file) != blob.size) exit(2);
    fclose(file);
    return blob;
}

static inline void free_blob(blob_file blob) { free(blob.block); }

/* An open asset with its blob; the process ends if it does not open. */
typedef struct opened {
    blob_file blob;
    pliant_asset asset;
    char name[64];
} opened;

static inline opened open_asset(const char* folder, const char* name)
{
    char path[1024];
    opened o;
    snprintf(path, sizeof path, "%s/%s.pliant", folder, name);
    snprintf(o.name, sizeof o.name, "%s", name);
    o.blob = read_blob(path);
    const pliant_result result = pliant_asset_open(&o.asset, o.blob.data, o.blob.size, PLIANT_OPEN_VERIFY_CHECKSUMS);
    if (result != PLIANT_OK) {
        fprintf(stderr, "%s: %s\n", path, pliant_result_text(result));
        exit(2);
    }
    return o;
}

/* Calls `each` for every asset named in FOLDER/assets.txt. */
static inline void for_each_asset(const char* folder, void (*each)(const opened*))
{
    char path[1024], name[64];
    snprintf(path, sizeof path, "%s/assets.txt", folder);
    FILE* list = fopen(path, "r");
    int count = 0;
    if (!list) {
        fprintf(stderr, "cannot read %s\n", path);
        exit(2);
    }
    while (fscanf(list, "%63s", name) == 1) {
        opened o = open_asset(folder, name);
        each(&o);
        free_blob(o.blob);
        ++count;
    }
    fclose(list);
    CHECK(count >= 5, "only %d assets in %s", count, path);
}

/* A solver in memory of its own, to be freed. */
typedef struct made_solver {
    pliant_solver* solver;
    void* memory;
    size_t size;
} made_solver;

static inline made_solver make_solver(const pliant_asset* asset, const pliant_solver_desc* desc)
{
    made_solver made = { NULL, NULL, pliant_solver_memory(asset, desc) };
    made.memory = malloc(made.size);
    if (!made.memory || pliant_solver_init(&made.solver, asset, desc, made.memory, made.size) != PLIANT_OK) {
        fprintf(stderr, "cannot make a solver\n");
        exit(2);
    }
    return made;
}

static inline void random_weights(uint64_t* state, uint32_t count, float* weights)
{
    for (uint32_t k = 0; k < count; ++k) weights[k] = random_unit(state) + 1e-6f;
}

/* Weights of any blend of the asset, weight_count of them. Of many layers only some are moved, as a face does: all of them
   together would be no shape. */
static inline void random_blend(uint64_t* state, const pliant_asset* asset, float* weights)
{
    random_weights(state, asset->weight_count, weights);
    for (uint32_t k = 0; asset->has_layers && k < asset->weight_count; ++k) {
        weights[k] = 1.4f * weights[k] - 0.4f;
        if (random_below(state, asset->weight_count) >= 3) weights[k] = 0.0f;
    }
}

#endif
