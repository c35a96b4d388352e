/* shapes ASSET.pliant OUT.bin: what the C runtime makes of 40 random weights, for test_morph.py to compare with a GLB: for
   each the weights, q, the morph weights and the boundary's positions, as floats. Exit code 3: the asset has no morph
   ranges. */
#include "../../../runtime/support.h"

/* The first rows are poses, or layers at the high end of their ranges; no row leaves the ranges. */
static void place_weight(const pliant_asset* asset, uint32_t k, int row, float* weights)
{
    pliant_weight weight;
    pliant_asset_weight(asset, k, &weight);
    if (row < 12) weights[k] = k == (uint32_t)row % asset->weight_count ? weight.high : 0.0f;
    if (weights[k] < weight.low) weights[k] = weight.low;
}

int main(int argc, char** argv)
{
    if (argc != 3) return 2;
    blob_file blob = read_blob(argv[1]);
    pliant_asset asset;
    if (pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_VERIFY_CHECKSUMS) != PLIANT_OK) return 1;
    const pliant_solver_desc desc = pliant_solver_desc_default();
    made_solver made = make_solver(&asset, &desc);
    float weights[64], q[256], morph[256];
    float* positions = malloc((size_t)asset.boundary_vertex_count * 12);
    FILE* out = fopen(argv[2], "wb");
    uint64_t state = 5;
    int exit_code = out && positions ? 0 : 1;
    for (int i = 0; i < 40 && exit_code == 0; ++i) {
        random_blend(&state, &asset, weights);
        for (uint32_t k = 0; k < asset.weight_count; ++k) place_weight(&asset, k, i, weights);
        if (pliant_solve(made.solver, weights, q, NULL) != PLIANT_OK) exit_code = 1;
        const pliant_result result = pliant_morph_weights(&asset, q, morph);
        if (result != PLIANT_OK) exit_code = result == PLIANT_ERROR_ABSENT ? 3 : 1;
        pliant_reconstruct(&asset, q, 0, asset.boundary_vertex_count, positions, 12);
        fwrite(weights, 4, asset.weight_count, out);
        fwrite(q, 4, asset.dimension, out);
        fwrite(morph, 4, asset.dimension, out);
        fwrite(positions, 12, asset.boundary_vertex_count, out);
    }
    if (out && fclose(out) != 0) exit_code = 1;
    free(positions);
    free(made.memory);
    free_blob(blob);
    return exit_code;
}
