#include "base/common/trial.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fcntl.h>
#include <new>
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

[[noreturn]] void try_in_child(int pipe, double seconds, double bytes, const std::function<void()>& work)
{
    for (const int standard : { 0, 1, 2 })
        if (standard != pipe) ::close(standard); // what is said here is not for the user
    std::set_new_handler([] { ::_exit(1); });    // before anyone catches bad_alloc
    if (bytes > 0.0) limit_memory(bytes);
    limit_time(seconds);
    try {
        work();
    } catch (const std::exception&) { // the parent meets it again
    }
    const char done = 1;
    ::_exit(::write(pipe, &done, 1) == 1 ? 0 : 1);
}

// Not by waitpid: a host may have the system collect its children.
bool is_told(int pipe)
{
    char done = 0;
    ssize_t count = 0;
    do count = ::read(pipe, &done, 1);
    while (count < 0 && errno == EINTR);
    return count == 1;
}

} // namespace

bool is_bounded(double seconds, double bytes, const std::function<void()>& work)
{
    int ends[2];
    if (::pipe(ends) != 0) return true;
    for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC); // another thread may start a program
    const double taken = address_space();
    const pid_t child = ::fork();
    if (child == 0) try_in_child(ends[1], seconds, taken > 0.0 ? taken + bytes : 0.0, work);
    ::close(ends[1]);
    const bool is_done = child < 0 || is_told(ends[0]);
    ::close(ends[0]);
    while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {}
    return is_done;
}

} // namespace pliant
