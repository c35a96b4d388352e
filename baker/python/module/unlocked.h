// The interpreter's lock given up for a while, and threads that outlive the interpreter.
#pragma once

#include <Python.h>
#include <chrono>
#include <exception>
#include <thread>

namespace pliant {

[[noreturn]] inline void sleep_for_ever()
{
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

// Make one just before a call that runs code of Python, after all objects that hold references. An interpreter that ends
// unwinds the thread inside the call. The destructor then lets the thread sleep, so that nothing counts references without
// the lock. A catch cannot do that: nanobind calls from within one, where libstdc++ terminates at a forced unwinding.
class PythonCall {
public:
    ~PythonCall()
    {
        if (!has_ended && std::uncaught_exceptions() == exceptions_before_) sleep_for_ever();
    }

    bool has_ended = false;

private:
    int exceptions_before_ = std::uncaught_exceptions();
};

// Other threads of Python run while one of these lives. When the interpreter has ended, CPython before 3.14 unwinds a thread
// that asks for the lock. A destructor cannot be unwound, so the thread sleeps until the process ends, as in CPython 3.14.
class Unlocked {
public:
    Unlocked()
        : state_(PyEval_SaveThread())
    {
    }
    ~Unlocked()
    {
        try {
            PyEval_RestoreThread(state_);
        } catch (...) {
            sleep_for_ever();
        }
    }
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;

private:
    PyThreadState* state_;
};

} // namespace pliant
