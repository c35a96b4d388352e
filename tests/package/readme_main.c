/* Runs the README's blend() on assets: the answers that an asset carries (chunk ANSW) must come out. */
#include "readme_snippet.c"

#include "pliant_format.h"

#include <math.h>
#include <stdio.h>

#define WEIGHT_COUNT 64 /* the format's limit of poses */
/* Of the distance between two poses. The solver's default tolerance is 1e-3, so processors may differ by about that. */
#define SHAPE_TOLERANCE 2e-3

/* The file in memory from malloc, or null. */
static void* file_read(const char* path, size_t* size)
{
    FILE* file = fopen(path, "rb");
    void* blob = NULL;
    long end = -1;
    if (file && fseek(file, 0, SEEK_END) == 0) end = ftell(file);
    if (end > 0 && fseek(file, 0, SEEK_SET) == 0) blob = malloc((size_t)end);
    if (blob && fread(blob, 1, (size_t)end, file) != (size_t)end) {
        free(blob);
        blob = NULL;
    }
    if (file) fclose(file);
    *size = blob ? (size_t)end : 0;
    return blob;
}

/* Root of the mean squared distance between two shapes. */
static double shape_distance(const float* a, const float* b, uint32_t vertex_count)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < 3 * vertex_count; ++i) sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
    return sqrt(sum / vertex_count);
}

/* How many stored answers blend() misses; an asset that does not open or carries none counts as one. */
static int asset_failures(const char* path, const void* blob, size_t size)
{
    pliant_asset asset;
    size_t chunk_size;
    int failures = 0;
    if (pliant_asset_open(&asset, blob, size, PLIANT_OPEN_VERIFY_CHECKSUMS) != PLIANT_OK) return 1;
    const unsigned char* chunk = pliant_asset_chunk(&asset, PLIANT_CHUNK_ANSWERS, &chunk_size);
    if (!chunk) return 1;
    const uint32_t answer_count = *(const uint32_t*)chunk;
    const float* answers = (const float*)(chunk + 64);
    float* wanted = malloc(asset.vertex_count * 3 * sizeof(float));
    float* blended = malloc(asset.vertex_count * 3 * sizeof(float));

    pliant_reconstruct(&asset, pliant_asset_pose_coordinates(&asset, 0), 0, asset.vertex_count, blended, 12);
    pliant_reconstruct(&asset, pliant_asset_pose_coordinates(&asset, 1), 0, asset.vertex_count, wanted, 12);
    const double pose_distance = shape_distance(blended, wanted, asset.vertex_count);
    for (uint32_t i = 0; i < answer_count; ++i) {
        const float* weights = answers + (size_t)i * (asset.pose_count + asset.dimension);
        pliant_reconstruct(&asset, weights + asset.pose_count, 0, asset.vertex_count, wanted, 12);
        const int done = blend(blob, size, weights + asset.has_layers, blended);
        const double error = shape_distance(blended, wanted, asset.vertex_count) / pose_distance;
        printf("%s: answer %u: relative error %.1e\n", path, (unsigned)i, error);
        if (!done || !(error < SHAPE_TOLERANCE)) ++failures;
    }
    free(blended);
    free(wanted);
    return failures + (answer_count == 0);
}

int main(int argc, char** argv)
{
    const float weights[WEIGHT_COUNT] = { 1.0f };
    float nothing[3];
    int failures = blend("not an asset, but long enough to be one if it were: 64 bytes are", 0, weights, nothing);
    for (int i = 1; i < argc; ++i) {
        size_t size;
        void* blob = file_read(argv[i], &size);
        failures += blob ? asset_failures(argv[i], blob, size) : 1;
        free(blob);
    }
    printf("%d failures\n", failures);
    return failures != 0;
}
