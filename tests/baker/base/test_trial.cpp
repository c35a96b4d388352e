// Work that is tried in a child process, and locks of children.
#include "base/common/per_process.h"
#include "base/common/trial.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <doctest/doctest.h>
#include <mutex>
#include <new>
#include <stdexcept>
#include <vector>

#ifdef __linux__
#include <pthread.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

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

#ifdef __linux__
pid_t bystander = 0;
bool has_bystander = false;

// In the middle of the fork of a trial, a child that lives on, as another thread might fork it.
void fork_bystander()
{
    if (!has_bystander) return;
    bystander = static_cast<pid_t>(::syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0)); // not fork(), which would come back here
    if (bystander != 0) return;
    ::sleep(20);
    ::_exit(0);
}
#endif

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

#ifdef __linux__
TEST_CASE("children that are forked meanwhile do not keep a trial from its end")
{
    REQUIRE(::pthread_atfork(fork_bystander, nullptr, nullptr) == 0);
    const auto start = std::chrono::steady_clock::now();
    has_bystander = true;
    CHECK_FALSE(is_bounded(0.1, 1e9, never_end));
    has_bystander = false;
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(15));
    REQUIRE(bystander > 0);
    ::kill(bystander, SIGKILL);
    ::waitpid(bystander, nullptr, 0);
}

TEST_CASE("a child that is forked while a thread holds a mutex of the process finds it free")
{
    std::mutex& mutex = per_process<std::mutex>();
    const std::lock_guard<std::mutex> held(mutex);
    const pid_t child = ::fork();
    if (child == 0) ::_exit(mutex.try_lock() ? 0 : 1);
    int status = -1;
    REQUIRE(::waitpid(child, &status, 0) == child);
    CHECK(status == 0);
}

TEST_CASE("a host may have the system collect its children")
{
    const auto before = std::signal(SIGCHLD, SIG_IGN);
    CHECK(is_bounded(10, 1e9, [] { take(1 << 20); }));
    CHECK_FALSE(is_bounded(0.1, 1e9, never_end));
    std::signal(SIGCHLD, before);
}
#endif
