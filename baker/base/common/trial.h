// Work on a stranger's bytes that a library may never end, tried in a child process first.
#pragma once

#include <cstddef>
#include <functional>

namespace pliant {

// False if `work` took more seconds of the processor or more bytes of memory than these, or ended the child. True if it
// returned or threw, and where no process can be started. Where there is no /proc (macOS) memory has no limit. `work` must
// not start threads, and must not take locks that other threads may hold: in the child nobody releases them.
bool is_bounded(double seconds, double bytes, const std::function<void()>& work);

} // namespace pliant
