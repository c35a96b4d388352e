// PLIANT_SKIP("reason"): leaves a doctest case that cannot run here. The reason is printed; if nothing in the executable
// failed, it exits with 77 and ctest counts it as skipped, so that a missing data set never looks like a pass.
#pragma once

namespace pliant_test {

void note_skip(const char* file, int line, const char* reason);

} // namespace pliant_test

#define PLIANT_SKIP(reason)                                   \
    do {                                                      \
        ::pliant_test::note_skip(__FILE__, __LINE__, reason); \
        return;                                               \
    } while (false)
