// Work that is tried in a child process.
#include "base/common/trial.h"

#include <cstdlib>
#include <doctest/doctest.h>
#include <new>
#include <stdexcept>
#include <vector>

using namespace pliant;

namespace {

volatile unsigned sink = 0;

void never_end()
{
    for (;;) sink = sink + 1;
}

void take(std::size_t bytes)
{
    std::vector<char> block(bytes);
    for (std::size_t i = 0; i < bytes; i += 4096) block[i] = 1;
    sink = static_cast<unsigned char>(block[bytes / 2]);
}

} // namespace

TEST_CASE("work that ends in time and memory is bounded, whatever it throws")
{
    CHECK(is_bounded(10, 1e9, [] { take(1 << 20); }));
    CHECK(is_bounded(10, 1e9, [] { throw std::runtime_error("the parent meets it again"); }));
    CHECK(sink == 0); // the child's work is not seen here
}

TEST_CASE("endless work, work that takes much memory, and work that ends the process are not")
{
    CHECK_FALSE(is_bounded(0.1, 1e9, never_end));
    CHECK_FALSE(is_bounded(10, 1e8, [] { take(std::size_t(1) << 30); }));
    CHECK_FALSE(is_bounded(10, 1e8, [] {
        try {
            take(std::size_t(1) << 30);
        } catch (const std::bad_alloc&) { // a library may think it can go on
        }
    }));
    CHECK_FALSE(is_bounded(10, 1e9, [] { std::_Exit(0); }));
}
