// main() of the doctest executables: doctest's own, plus exit code 77 if a case was skipped and none failed.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "skip.h"

#include <atomic>
#include <cstdio>

namespace {

std::atomic<int> skip_count { 0 };

} // namespace

void pliant_test::note_skip(const char* file, int line, const char* reason)
{
    ++skip_count;
    std::printf("%s:%d: skipped: %s\n", file, line, reason);
}

int main(int argc, char** argv)
{
    doctest::Context context(argc, argv);
    const int result = context.run();
    if (context.shouldExit() || result != 0) return result;
    return skip_count > 0 ? 77 : 0;
}
