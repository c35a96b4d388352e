#include "base/common/trial.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pliant {
namespace {

// Bytes of address space; 0 if unknown.
double address_space()
{
    std::FILE* file = std::fopen("/proc/self/statm", "r");
    unsigned long pages = 0;
    const bool is_read = file && std::fscanf(file, "%lu", &pages) == 1;
    if (file) std::fclose(file);
    return is_read ? double(pages) * double(::sysconf(_SC_PAGESIZE)) : 0.0;
}

void limit_memory(double bytes)
{
    rlimit limit {};
    if (::getrlimit(RLIMIT_AS, &limit) != 0) return;
    const double most = static_cast<double>(limit.rlim_max); // RLIM_INFINITY is the largest of all
    if (bytes < most) limit.rlim_cur = static_cast<rlim_t>(bytes);
    ::setrlimit(RLIMIT_AS, &limit);
}

void limit_time(double seconds)
{
    itimerval timer {};
    timer.it_value.tv_sec = static_cast<time_t>(seconds);
    timer.it_value.tv_usec = static_cast<suseconds_t>(std::max(1.0, 1e6 * (seconds - double(timer.it_value.tv_sec))));
    sigset_t blocked;
    ::sigemptyset(&blocked);
    ::sigaddset(&blocked, SIGPROF);
    ::sigprocmask(SIG_UNBLOCK, &blocked, nullptr);
    std::signal(SIGPROF, SIG_DFL); // ends the process
    ::setitimer(ITIMER_PROF, &timer, nullptr);
}

[[noreturn]] void try_in_child(volatile char* is_done, double seconds, double bytes, const std::function<void()>& work)
{
    for (const int standard : { 0, 1, 2 }) ::close(standard); // what is said here is not for the user
    std::set_new_handler([] { ::_exit(1); });                 // before anyone catches bad_alloc
    if (bytes > 0.0) limit_memory(bytes);
    limit_time(seconds);
    try {
        work();
    } catch (const std::exception&) { // the parent meets it again
    }
    *is_done = 1;
    ::_exit(0);
}

} // namespace

bool is_bounded(double seconds, double bytes, const std::function<void()>& work)
{
    // Neither an exit code, since a host may have the system collect its children, nor a pipe, since what another thread
    // forks would keep it open.
    void* shared = ::mmap(nullptr, 1, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) return true;
    volatile char* is_done = static_cast<char*>(shared);
    const double taken = address_space();
    const pid_t child = ::fork();
    if (child == 0) try_in_child(is_done, seconds, taken > 0.0 ? taken + bytes : 0.0, work);
    while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {}
    const bool is_bounded = child < 0 || *is_done == 1;
    ::munmap(shared, 1);
    return is_bounded;
}

} // namespace pliant
