/* Opens an old asset, solves its stored answers again, compares the shapes. */
#include "../../formats/pliant_format.h"
#include "../runtime/support.h"

#include <math.h>

/* Largest vertex distance of two blends over the size of the shape. */
static double difference(const pliant_asset* asset, const float* q, const float* stored)
{
    double error = 0.0, size = 0.0;
    for (uint32_t v = 0; v < asset->vertex_count; ++v) {
        float a[3], b[3];
        double distance = 0.0, radius = 0.0;
        pliant_reconstruct(asset, q, v, 1, a, 12);
        pliant_reconstruct(asset, stored, v, 1, b, 12);
        for (int c = 0; c < 3; ++c) {
            distance += (double)((a[c] - b[c]) * (a[c] - b[c]));
            radius += (double)((b[c] - asset->origin[c]) * (b[c] - asset->origin[c]));
        }
        if (distance > error) error = distance;
        if (radius > size) size = radius;
    }
    return sqrt(error / size);
}

/* The format version that has all that an asset holds. */
static uint16_t oldest_minor(const pliant_asset* asset)
{
    const pliant_format_batch* batches = asset->batches;
    int is_solid = asset->quartic || asset->source_vertices;
    int has_parts = asset->columns || asset->bounds || asset->smoothing_groups || asset->morph_ranges
        || pliant_asset_chunk(asset, PLIANT_CHUNK_SCENE, NULL);
    for (uint32_t i = 0; i < asset->batch_count; ++i) {
        is_solid |= batches[i].kind == PLIANT_ELEMENT_TET_STVK || batches[i].kind == PLIANT_ELEMENT_TET_MOONEY_RIVLIN;
        has_parts |= batches[i].kind == PLIANT_ELEMENT_TIE;
    }
    if (asset->has_layers) return PLIANT_FORMAT_MINOR_LAYERS;
    if (asset->products) return PLIANT_FORMAT_MINOR_FACTORED;
    if (has_parts) return PLIANT_FORMAT_MINOR_PARTS;
    if (is_solid) return PLIANT_FORMAT_MINOR_SOLID;
    return asset->load_coefficients ? PLIANT_FORMAT_MINOR_LOAD : 0;
}

int main(int argc, char** argv)
{
    for (int i = 1; i < argc; ++i) {
        const blob_file blob = read_blob(argv[i]);
        pliant_asset asset;
        const pliant_result result = pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_VERIFY_CHECKSUMS);
        CHECK(result == PLIANT_OK, "%s: %s", argv[i], pliant_result_text(result));
        if (result != PLIANT_OK) continue;
        size_t size;
        const unsigned char* chunk = pliant_asset_chunk(&asset, PLIANT_CHUNK_ANSWERS, &size);
        const uint32_t count = ((const pliant_format_count*)(const void*)chunk)->count;
        const float* answer = (const float*)(const void*)(chunk + sizeof(pliant_format_count));
        pliant_solver_desc desc = pliant_solver_desc_default();
        desc.tolerance = 1e-4f;
        const made_solver made = make_solver(&asset, &desc);
        CHECK(count >= 3, "%s: %u answers", argv[i], count);
        for (uint32_t k = 0; k < count; ++k, answer += asset.pose_count + asset.dimension) {
            float q[PLIANT_FORMAT_MAX_DIMENSION];
            pliant_solver_reset(made.solver);
            CHECK(pliant_solve(made.solver, answer + asset.has_layers, q, NULL) == PLIANT_OK, "%s: answer %u", argv[i], k);
            CHECK(difference(&asset, q, answer + asset.pose_count) < 1e-4, "%s: answer %u is off by %.3g", argv[i], k,
                  difference(&asset, q, answer + asset.pose_count));
        }
        free(made.memory);
        const uint16_t minor = ((const pliant_format_header*)(const void*)blob.data)->format_minor;
        CHECK(minor == oldest_minor(&asset), "%s: minor version %u", argv[i], minor);
        free_blob(blob);
    }
    return argc < 2 ? 2 : report("golden");
}
