#include "base/common/memory.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace pliant {
namespace {

// Of the address space, or of what may be written to; infinite if there is none.
double limit_of_process()
{
    double bytes = std::numeric_limits<double>::infinity();
    for (const auto resource : { RLIMIT_AS, RLIMIT_DATA }) {
        rlimit limit {};
        if (::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
            bytes = std::min(bytes, double(limit.rlim_cur));
    }
    return bytes;
}

} // namespace

double available_memory()
{
    double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
    for (const char* path : { "/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes" }) {
        double limit = 0; // "max" is no number, and no limit
        if (std::ifstream(path) >> limit && limit > 0) bytes = std::min(bytes, limit);
    }
    return std::min(bytes, limit_of_process());
}

bool is_memory_limited()
{
    constexpr int never_overcommits = 2;
    int mode = 0;
    std::ifstream("/proc/sys/vm/overcommit_memory") >> mode;
    return mode == never_overcommits || std::isfinite(limit_of_process());
}

bool has_room(std::size_t size)
{
    void* const room = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    return room != MAP_FAILED && ::munmap(room, size) == 0;
}

} // namespace pliant
