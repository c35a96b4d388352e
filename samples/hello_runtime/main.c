/* The shortest useful program with Pliant's runtime: hello_runtime ASSET [WEIGHT...]
   Opens an asset, blends its poses or layers (by the weights given, else by those to start with), prints the answer. */
#include <pliant.h>

#include <stdio.h>
#include <stdlib.h>

/* The whole file in memory of malloc, whose alignment is what an asset wants. Null if it cannot be read. */
static void* read_file(const char* path, size_t* size)
{
    FILE* file = fopen(path, "rb");
    void* bytes = NULL;
    long end;
    if (!file) return NULL;
    if (fseek(file, 0, SEEK_END) == 0 && (end = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0) {
        *size = (size_t)end;
        bytes = malloc(*size);
        if (bytes && fread(bytes, 1, *size, file) != *size) {
            free(bytes);
            bytes = NULL;
        }
    }
    fclose(file);
    return bytes;
}

static int fail(const char* what, const char* reason)
{
    fprintf(stderr, "hello_runtime: error: %s: %s\n", what, reason);
    return 1;
}

int main(int argc, char** argv)
{
    static const char* const status_names[] = { "converged", "limit", "stalled" };
    if (argc < 2) return fail("usage", "hello_runtime ASSET [WEIGHT...]");

    size_t size = 0;
    void* blob = read_file(argv[1], &size);
    if (!blob) return fail(argv[1], "cannot be read");

    pliant_asset asset;
    pliant_result result = pliant_asset_open(&asset, blob, size, PLIANT_OPEN_VERIFY_CHECKSUMS);
    if (result != PLIANT_OK) return fail(argv[1], pliant_result_text(result));

    pliant_solver_desc desc = pliant_solver_desc_default();
    size_t memory_size = pliant_solver_memory(&asset, &desc);
    void* memory = malloc(memory_size);
    float* weights = malloc(asset.weight_count * sizeof(float));
    float* q = malloc(asset.dimension * sizeof(float));
    if (!memory || !weights || !q) return fail(argv[1], "out of memory");
    pliant_solver* solver;
    result = pliant_solver_init(&solver, &asset, &desc, memory, memory_size);
    if (result != PLIANT_OK) return fail("solver", pliant_result_text(result));

    for (uint32_t k = 0; k < asset.weight_count; ++k) {
        pliant_weight weight;
        pliant_asset_weight(&asset, k, &weight);
        weights[k] = argc == 2 ? weight.initial : (int)k + 2 < argc ? strtof(argv[k + 2], NULL) : 0.0f;
        printf("weight %-8g %s\n", weights[k], weight.name);
    }
    pliant_solve_info info;
    result = pliant_solve(solver, weights, q, &info); /* once per frame */
    if (result != PLIANT_OK) return fail("weights", pliant_result_text(result));
    printf("%s: %u iterations, %u evaluations\nq", status_names[info.status], info.iterations, info.evaluations);
    for (uint32_t j = 0; j < asset.dimension; ++j) printf(" %g", q[j]);

    float vertices[3][3];
    pliant_reconstruct(&asset, q, 0, 3, vertices[0], sizeof vertices[0]); /* any range, any stride */
    printf("\nfirst of %u vertices\n", asset.vertex_count);
    for (uint32_t v = 0; v < 3 && v < asset.vertex_count; ++v)
        printf("  %g %g %g\n", vertices[v][0], vertices[v][1], vertices[v][2]);
    if (fflush(stdout) != 0) return fail("standard output", "cannot be written");
    free(q), free(weights), free(memory), free(blob);
    return 0;
}
