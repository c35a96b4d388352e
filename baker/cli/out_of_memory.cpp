#include "cli/out_of_memory.h"

#include "base/common/diagnostics.h"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <unistd.h>

namespace pliant {
namespace {

bool is_watching = false;

[[noreturn]] void end_without_memory()
{
    print_out_of_memory();
    ::_exit(int(ExitCode::failed));
}

void end_if_watching()
{
    if (is_watching) end_without_memory();
}

// The first to run of all that runs before main.
[[gnu::constructor(101)]] void install_handler() { std::set_new_handler(end_without_memory); }

} // namespace

void print_out_of_memory()
{
    std::fputs("pliant: error P4901: memory ran out\n  hint: `pliant check` estimates the memory of a bake\n", stderr);
}

ExitWatch::ExitWatch() { is_watching = std::atexit(end_if_watching) == 0; }
ExitWatch::~ExitWatch() { is_watching = false; }

} // namespace pliant

#ifdef PLIANT_WRAPS_MALLOC // the linker leads the calls of the tool's objects here, so those of Eigen
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_realloc(void* old, std::size_t size);

void* __wrap_malloc(std::size_t size)
{
    void* const memory = __real_malloc(size);
    if (!memory && size > 0) pliant::end_without_memory();
    return memory;
}

void* __wrap_realloc(void* old, std::size_t size)
{
    void* const memory = __real_realloc(old, size);
    if (!memory && size > 0) pliant::end_without_memory();
    return memory;
}
}
#endif
