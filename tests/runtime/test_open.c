/* Opening anything: every truncation, every bit of header and chunk table, of some assets every value of every byte, ten
   thousand random corruptions, any alignment. Refused or harmless; run under sanitizers to be told of the rest. */
#include "../../formats/pliant_format.h"
#include "hostile.h"

static void check_truncation(const opened* o)
{
    cage c = make_cage(o->blob.size);
    for (size_t size = 0; size < o->blob.size; ++size) {
        const pliant_result result = exercise(cage_blob(&c, o->blob.data, size), size);
        CHECK(result == PLIANT_ERROR_TRUNCATED, "%s: %zu of %zu bytes: %s", o->name, size, o->blob.size,
              pliant_result_text(result));
        if (size > 2048 && size + 2048 < o->blob.size) size += 61; /* the middle is like itself */
    }
    /* The stated size lowered as well: now the chunks stick out. */
    unsigned char* copy = malloc(o->blob.size);
    if (!copy) exit(2);
    memcpy(copy, o->blob.data, o->blob.size);
    for (size_t size = 64; size < o->blob.size; size += size < 1024 ? 1 : 97) {
        const uint64_t stated = size;
        memcpy(copy + 16, &stated, sizeof stated);
        CHECK(exercise(cage_blob(&c, copy, size), size) == PLIANT_ERROR_LAYOUT, "%s: cut to %zu", o->name, size);
    }
    free(copy);
    munmap(c.pages, c.room);
}

static void check_header_bytes(const opened* o)
{
    const size_t end = sizeof(pliant_format_header)
        + (size_t)((const pliant_format_header*)(const void*)o->blob.data)->chunk_count * sizeof(pliant_format_chunk);
    cage c = make_cage(o->blob.size);
    unsigned char* copy = malloc(o->blob.size);
    /* Headers are much alike: every bit of all, every value of two. */
    const int has_all_values = strcmp(o->name, "strip_neo") == 0 || strcmp(o->name, "layers_line") == 0;
    long refused = 0, tried = 0;
    if (!copy) exit(2);
    memcpy(copy, o->blob.data, o->blob.size);
    for (size_t at = 0; at < end; ++at)
        for (int value = 0; value < 256; ++value) {
            const int changed = value ^ o->blob.data[at], is_one_bit = (changed & (changed - 1)) == 0;
            if (!has_all_values && !is_one_bit) continue;
            ++tried;
            copy[at] = (unsigned char)value;
            refused += exercise(cage_blob(&c, copy, o->blob.size), o->blob.size) != PLIANT_OK;
            copy[at] = o->blob.data[at];
        }
    CHECK(refused > tried * 100 / 256, "%s: only %ld refused", o->name, refused);
    printf("%s: %zu header bytes, %ld of %ld values refused\n", o->name, end, refused, tried);
    free(copy);
    munmap(c.pages, c.room);
}

/* 32- and 64-bit fields set to the numbers that break arithmetic. */
static void check_extreme_fields(const opened* o)
{
    const uint64_t size = o->blob.size;
    const uint64_t values[] = { 0,
                                1,
                                2,
                                15,
                                16,
                                63,
                                64,
                                4096,
                                0x7FFFFFFF,
                                0x80000000,
                                0xFFFFFFFE,
                                0xFFFFFFFF,
                                0x100000000,
                                0x7FFFFFFFFFFFFFFF,
                                0x8000000000000000,
                                0xFFFFFFFFFFFFFFFF,
                                0xFFFFFFFFFFFFFFC0,
                                size,
                                size - 1,
                                size + 1,
                                size - 64,
                                (uint64_t)0 - size,
                                1u << 26,
                                1u << 22 };
    const size_t count = sizeof values / sizeof *values;
    cage c = make_cage(o->blob.size);
    unsigned char* copy = malloc(o->blob.size);
    if (!copy) exit(2);
    memcpy(copy, o->blob.data, o->blob.size);
    /* Large blobs are slow to copy where every access is checked. */
    const size_t step = SLOWNESS > 1 && o->blob.size > 65536 ? 36 : 4;
    for (size_t at = 0; at + 8 <= 4096 && at + 8 <= o->blob.size; at += step)
        for (size_t i = 0; i < count; ++i)
            for (size_t width = 4; width <= 8; width += 4) {
                memcpy(copy + at, &values[i], width);
                exercise(cage_blob(&c, copy, o->blob.size), o->blob.size);
                memcpy(copy + at, o->blob.data + at, width);
            }
    free(copy);
    munmap(c.pages, c.room);
}

static void check_corruption(const opened* o)
{
    cage c = make_cage(o->blob.size);
    unsigned char* copy = malloc(o->blob.size);
    uint64_t state = 53;
    /* ARAP costs a hundred times a hinge, more under sanitizers. */
    const int rounds = (strstr(o->name, "mixed") ? 1000 : 10000) / SLOWNESS;
    int survived = 0;
    if (!copy) exit(2);
    for (int round = 0; round < rounds; ++round) {
        const uint32_t changes = 1 + random_below(&state, 8);
        memcpy(copy, o->blob.data, o->blob.size);
        for (uint32_t i = 0; i < changes; ++i) {
            /* Half of the changes hit the first kilobyte, where structure is. */
            const uint32_t limit = random_below(&state, 2) ? 1024 : (uint32_t)o->blob.size;
            copy[random_below(&state, limit)] = (unsigned char)random_bits(&state);
        }
        survived += exercise(cage_blob(&c, copy, o->blob.size), o->blob.size) == PLIANT_OK;
    }
    CHECK(survived > 0 && survived < rounds, "%s: %d of %d opened", o->name, survived, rounds);
    printf("%s: %d corruptions, %d opened\n", o->name, rounds, survived);
    free(copy);
    munmap(c.pages, c.room);
}

static void check_alignment(const opened* o)
{
    unsigned char* room = malloc(o->blob.size + 128);
    pliant_asset asset;
    if (!room) exit(2);
    for (size_t shift = 0; shift < 64; ++shift) {
        unsigned char* start = room + (64 - (uintptr_t)room % 64) % 64 + shift;
        memcpy(start, o->blob.data, o->blob.size);
        const pliant_result result = pliant_asset_open(&asset, start, o->blob.size, PLIANT_OPEN_DEFAULT);
        CHECK(result == (shift % 16 ? PLIANT_ERROR_ALIGNMENT : PLIANT_OK), "%s: shift %zu: %s", o->name, shift,
              pliant_result_text(result));
    }
    free(room);
}

static void check_arguments(const opened* o)
{
    pliant_asset asset;
    CHECK(pliant_asset_open(NULL, o->blob.data, o->blob.size, 0) == PLIANT_ERROR_ARGUMENT, "no out");
    CHECK(pliant_asset_open(&asset, NULL, o->blob.size, 0) == PLIANT_ERROR_ARGUMENT, "no blob");
    CHECK(pliant_asset_open(&asset, o->blob.data, 0, 0) == PLIANT_ERROR_TRUNCATED, "no bytes");
    CHECK(pliant_asset_open(&asset, o->blob.data, o->blob.size, 2) == PLIANT_ERROR_ARGUMENT, "an unknown flag");
    CHECK(pliant_version() == PLIANT_VERSION_MAJOR * 10000 + PLIANT_VERSION_MINOR * 100 + PLIANT_VERSION_PATCH, "version");
    for (int code = -1; code < 64; ++code) CHECK(strlen(pliant_result_text((pliant_result)code)) > 3, "text of %d", code);
}

int main(int argc, char** argv)
{
    if (argc < 3) return 2;
    for (int i = 2; i < argc; ++i) {
        const opened o = open_asset(argv[1], argv[i]);
        check_arguments(&o);
        check_alignment(&o);
        check_truncation(&o);
        if (!strstr(o.name, "mixed")) {
            check_header_bytes(&o);
            check_extreme_fields(&o);
        }
        check_corruption(&o);
        free_blob(o.blob);
    }
    return report("open");
}
