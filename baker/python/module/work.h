// Long work for Python: the interpreter stays free meanwhile, and Ctrl-C ends it.
#pragma once

#include "base/common/progress.h"

#include <functional>
#include <nanobind/nanobind.h>

namespace pliant {

// What Python hears of work that goes on. Both are called with the interpreter locked, on the thread that asked for the
// work.
struct Listener {
    nanobind::object progress; // called as progress(stage, done, total), or None
    nanobind::object warn;     // called as warn(number, what, hint)
};

// Runs `work` on a thread of its own, with the given number of threads for its loops (0: as many as the machine has), and
// returns when it has ended. The caller waits without the interpreter's lock, and looks for signals and news twenty times a
// second: what a signal handler or the listener raises (KeyboardInterrupt, a warning made an error) stops the work at its
// next Progress::update, and is raised here once it has ended. Works of one process take turns, as the number of threads is
// one for all; waiting can be interrupted, too. Throws what `work` throws, and std::runtime_error for a work that the
// listener of another one asks for, which would wait for itself. Call with the interpreter locked.
void work_interruptibly(const Listener& listener, unsigned thread_count, const std::function<void(Progress&)>& work);

// Stops the work that still goes on when the interpreter has ended, which does not wait for daemon threads: it must not
// outlive what it works with. Waits some seconds.
void end_work();

} // namespace pliant
