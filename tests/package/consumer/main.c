/* A program outside the project that has nothing but an installed (or embedded) runtime. Prints version and results; fails
   if the library is not the one of the header, or does not answer. */
#include <pliant.h>
#include <stdio.h>

int main(void)
{
    const uint32_t expected = PLIANT_VERSION_MAJOR * 10000u + PLIANT_VERSION_MINOR * 100u + PLIANT_VERSION_PATCH;
    double aligned_blob[8] = { 0 };
    pliant_asset asset;
    const pliant_result ok = PLIANT_OK;
    const pliant_result short_blob = pliant_asset_open(&asset, aligned_blob, 8, PLIANT_OPEN_DEFAULT);
    const pliant_result no_blob = pliant_asset_open(&asset, NULL, 0, PLIANT_OPEN_DEFAULT);

    printf("pliant %u\n", (unsigned)pliant_version());
    printf("%s\n%s\n%s\n", pliant_result_text(ok), pliant_result_text(short_blob), pliant_result_text(no_blob));
    if (pliant_version() != expected) return 1;
    if (short_blob != PLIANT_ERROR_TRUNCATED || no_blob == PLIANT_OK) return 2;
    if (pliant_solver_desc_default().struct_size != sizeof(pliant_solver_desc)) return 3;
    return 0;
}
