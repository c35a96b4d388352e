// Readers under damaged files: many mutations of one sample, read in child processes, so that a crash is a failure and not
// the end.
#pragma once

#include "files.h"

#include <algorithm>
#include <random>
#include <sys/mman.h>
#include <sys/wait.h>

namespace pliant_test {

// Number of the first of `count` mutations at which a child crashed, did not end within five seconds, or found reading not
// sane;
// -1: none. mutate(sample, random) gives the bytes that are written to `path`, is_sane() reads them.
template <class Mutate, class IsSane>
int first_failure(const std::string& path, const std::string& sample, unsigned count, Mutate mutate, IsSane is_sane)
{
    constexpr unsigned batch_size = 250; // children are costly under sanitizers
    auto* current = static_cast<volatile int*>(
        ::mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    int failed = -1;
    for (unsigned begin = 0; begin < count && failed < 0; begin += batch_size) {
        const pid_t child = ::fork();
        if (child == 0) {
            for (unsigned i = begin; i < std::min(begin + batch_size, count); ++i) {
                *current = static_cast<int>(i);
                ::alarm(5); // kills a reader that does not end
                std::mt19937 random(i);
                write_bytes(path, mutate(sample, random));
                if (!is_sane()) ::_exit(1);
            }
            ::_exit(0);
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) failed = *current;
    }
    ::munmap(const_cast<int*>(current), sizeof(int));
    return failed;
}

} // namespace pliant_test
