// Work on a stranger's bytes that a library may never end, tried in a child process first.
#pragma once

#include <cstddef>
#include <functional>

namespace pliant {

// False if `work` took more seconds of the processor or more bytes of memory than these, or ended the child. True if it
// returned or threw, and where no process can be started. Where /proc does not say what this process has (macOS), memory
// has no limit. `work` must not start threads or take locks: of the other threads the child has only what they held.
bool is_bounded(double seconds, double bytes, const std::function<void()>& work);

} // namespace pliant
