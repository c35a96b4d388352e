/* One file for each way to break each rule of formats/SPEC.md: refused with the code in its name, with checksums checked and
   (but for files that are about checksums) without, also by a thread that takes denormal numbers for 0. Argument: the folder
   of make_bad_assets.py. */
#include "hostile.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
static void take_denormals_for_zero(int yes)
{
    const unsigned flags = 0x8040; /* of results, and of what is read */
    _mm_setcsr(yes ? _mm_getcsr() | flags : _mm_getcsr() & ~flags);
}
#else
static void take_denormals_for_zero(int yes) { (void)yes; }
#endif

int main(int argc, char** argv)
{
    char path[1024], name[128];
    int count = 0;
    if (argc != 2) return 2;
    snprintf(path, sizeof path, "%s/museum.txt", argv[1]);
    FILE* list = fopen(path, "r");
    if (!list) return 2;
    while (fscanf(list, "%127s", name) == 1) {
        const int expected = atoi(strchr(name, '.') + 1);
        snprintf(path, sizeof path, "%s/%s.pliant", argv[1], name);
        const blob_file blob = read_blob(path);
        cage c = make_cage(blob.size + 1);
        const unsigned char* bytes = cage_blob(&c, blob.data, blob.size);
        pliant_asset asset;
        pliant_result result = pliant_asset_open(&asset, bytes, blob.size, PLIANT_OPEN_VERIFY_CHECKSUMS);
        CHECK((int)result == expected, "%s: %d, %s", name, (int)result, pliant_result_text(result));
        result = exercise(bytes, blob.size);
        CHECK((int)result == (expected == PLIANT_ERROR_CHECKSUM ? PLIANT_OK : expected), "%s, checksums unchecked: %d, %s",
              name, (int)result, pliant_result_text(result));
        take_denormals_for_zero(1);
        const pliant_result flushed = exercise(bytes, blob.size);
        CHECK(flushed == result || strncmp(name, "R21", 3) != 0, "%s: where its parts are depends on the processor", name);
        take_denormals_for_zero(0);
        munmap(c.pages, c.room);
        free_blob(blob);
        ++count;
    }
    fclose(list);
    CHECK(count > 80, "only %d files", count);
    printf("%d files\n", count);
    return report("museum");
}
