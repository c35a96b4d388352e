/* Morph weights: the map that SPEC.md defines, refusals. The asset inside a GLB: found where it is,
   and nowhere in damaged bytes. */
#include "support.h"

#include "pliant_format.h"

#include <math.h>

static void check_weights(const opened* o)
{
    const uint32_t d = o->asset.dimension;
    const float* low = o->asset.morph_ranges;
    float q[256] = { 0 }, weights[256];
    uint64_t state = 11;
    if (!low) {
        memset(weights, 0x55, sizeof weights);
        CHECK(pliant_morph_weights(&o->asset, q, weights) == PLIANT_ERROR_ABSENT, "%s", o->name);
        for (size_t i = 0; i < sizeof weights; ++i) CHECK(((unsigned char*)weights)[i] == 0x55, "%s: wrote", o->name);
        return;
    }
    const float* high = low + o->asset.padded_dimension;
    for (int round = 0; round < 20; ++round) {
        for (uint32_t j = 0; j < d; ++j) q[j] = 2.0f * random_unit(&state) - 1.0f;
        CHECK(pliant_morph_weights(&o->asset, q, weights) == PLIANT_OK, "%s", o->name);
        for (uint32_t j = 0; j < d; ++j) {
            const double back = (double)low[j] + (double)weights[j] * ((double)high[j] - (double)low[j]);
            const double size = fabs((double)low[j]) + fabs((double)high[j]) + fabs((double)q[j]);
            CHECK(fabs(back - (double)q[j]) < 1e-6 * size, "%s: %u", o->name, j);
        }
    }
    CHECK(pliant_morph_weights(&o->asset, low, weights) == PLIANT_OK && weights[0] == 0.0f, "%s: low", o->name);
    CHECK(pliant_morph_weights(&o->asset, high, weights) == PLIANT_OK && weights[d - 1] == 1.0f, "%s: high", o->name);
    memcpy(q, high, d * sizeof(float));
    CHECK(pliant_morph_weights(&o->asset, q, q) == PLIANT_OK && q[0] == 1.0f, "%s: in place", o->name);
    CHECK(pliant_morph_weights(NULL, q, weights) == PLIANT_ERROR_ARGUMENT, "no asset");
    CHECK(pliant_morph_weights(&o->asset, NULL, weights) == PLIANT_ERROR_ARGUMENT, "no q");
    CHECK(pliant_morph_weights(&o->asset, q, NULL) == PLIANT_ERROR_ARGUMENT, "no weights");
}

/* A range of no width: its target moves nothing, its weight is 0. */
static void check_flat_range(const char* folder)
{
    opened o = open_asset(folder, "beam_ranges");
    size_t size;
    const unsigned char* chunk = pliant_asset_chunk(&o.asset, PLIANT_CHUNK_MORPH_RANGES, &size);
    unsigned char* ranges = o.blob.data + (chunk - o.blob.data);
    float q[256] = { 0 }, weights[256];
    memcpy(ranges, ranges + size / 2, sizeof(float));
    CHECK(pliant_asset_open(&o.asset, o.blob.data, o.blob.size, PLIANT_OPEN_DEFAULT) == PLIANT_OK, "flat range");
    CHECK(pliant_morph_weights(&o.asset, q, weights) == PLIANT_OK && weights[0] == 0.0f, "flat range");
    free_blob(o.blob);
}

static void put_word(unsigned char* at, uint32_t value)
{
    for (int i = 0; i < 4; ++i) at[i] = (unsigned char)(value >> (8 * i));
}

/* A GLB with `json` bytes of JSON, then `asset` at the start of the binary chunk and `behind` bytes. */
static blob_file make_glb(size_t json, const blob_file* asset, size_t behind)
{
    const size_t binary = asset->size + behind, total = 12 + 8 + json + 8 + binary;
    blob_file glb = make_blob(NULL, total);
    memset(glb.data, ' ', total);
    put_word(glb.data, 0x46546C67u);
    put_word(glb.data + 4, 2);
    put_word(glb.data + 8, (uint32_t)total);
    put_word(glb.data + 12, (uint32_t)json);
    put_word(glb.data + 16, 0x4E4F534Au);
    put_word(glb.data + 20 + json, (uint32_t)binary);
    put_word(glb.data + 24 + json, 0x004E4942u);
    memcpy(glb.data + 28 + json, asset->data, asset->size);
    return glb;
}

static void check_glb(const opened* o)
{
    size_t offset, size;
    const size_t json = 4096 - 28;
    blob_file glb = make_glb(json, &o->blob, 36);
    pliant_asset asset;
    CHECK(pliant_glb_find(glb.data, glb.size, &offset, &size) == PLIANT_OK && offset == 4096 && size == o->blob.size, "%s",
          o->name);
    CHECK(pliant_asset_open(&asset, glb.data + offset, size, PLIANT_OPEN_VERIFY_CHECKSUMS) == PLIANT_OK, "%s", o->name);
    for (size_t cut = 0; cut < glb.size; cut += cut < 5000 ? 1 : 997) {
        blob_file part = make_blob(glb.data, cut); /* of its own size, so that sanitizers see a read behind it */
        CHECK(pliant_glb_find(cut ? part.data : NULL, cut, &offset, &size) != PLIANT_OK && !offset && !size, "cut to %zu",
              cut);
        free_blob(part);
    }
    free_blob(glb);
}

/* Whatever the bytes say, what is found lies inside. */
static void check_damaged_glb(const opened* o)
{
    static const uint32_t values[] = { 0, 1, 11, 12, 19, 20, 28, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu, 0xFFFFFFF0u };
    const size_t places[] = { 0, 4, 8, 12, 16, 20 + 32, 24 + 32, 28 + 32, 28 + 32 + 16, 28 + 32 + 20 };
    for (size_t p = 0; p < sizeof places / sizeof *places; ++p)
        for (size_t v = 0; v < sizeof values / sizeof *values; ++v) {
            blob_file glb = make_glb(32, &o->blob, 0);
            size_t offset, size;
            put_word(glb.data + places[p], values[v]);
            const pliant_result result = pliant_glb_find(glb.data, glb.size, &offset, &size);
            CHECK(offset <= glb.size && size <= glb.size - offset, "%zu %zu", p, v);
            CHECK((result == PLIANT_OK) == (size != 0), "%zu %zu: %d", p, v, (int)result);
            free_blob(glb);
        }
    blob_file glb = make_glb(32, &o->blob, 0);
    size_t offset = 1, size = 1;
    CHECK(pliant_glb_find(o->blob.data, o->blob.size, &offset, &size) == PLIANT_ERROR_NOT_PLIANT, "an asset is no GLB");
    CHECK(pliant_glb_find(NULL, 100, &offset, &size) == PLIANT_ERROR_ARGUMENT, "null");
    CHECK(pliant_glb_find(glb.data, glb.size, NULL, &size) == PLIANT_ERROR_ARGUMENT, "null");
    CHECK(pliant_glb_find(glb.data, glb.size, &offset, NULL) == PLIANT_ERROR_ARGUMENT, "null");
    glb.data[28 + 32] ^= 1;
    CHECK(pliant_glb_find(glb.data, glb.size, &offset, &size) == PLIANT_ERROR_ABSENT, "another binary chunk");
    put_word(glb.data + 8, 20 + 32); /* no binary chunk */
    CHECK(pliant_glb_find(glb.data, glb.size, &offset, &size) == PLIANT_ERROR_ABSENT, "no binary chunk");
    put_word(glb.data + 4, 1);
    CHECK(pliant_glb_find(glb.data, glb.size, &offset, &size) == PLIANT_ERROR_NOT_PLIANT, "version 1");
    free_blob(glb);
}

int main(int argc, char** argv)
{
    if (argc < 2) return 2;
    for_each_asset(argv[1], check_weights);
    check_flat_range(argv[1]);
    opened o = open_asset(argv[1], "tube_ranges");
    check_glb(&o);
    check_damaged_glb(&o);
    free_blob(o.blob);
    return report("morph");
}
