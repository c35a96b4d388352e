/* One file for each way to break each rule of formats/SPEC.md: refused with the code in its name, with checksums checked and
   (but for files that are about checksums) without. Argument: the folder of make_bad_assets.py. */
#include "hostile.h"

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
        munmap(c.pages, c.room);
        free_blob(blob);
        ++count;
    }
    fclose(list);
    CHECK(count > 80, "only %d files", count);
    printf("%d files\n", count);
    return report("museum");
}
