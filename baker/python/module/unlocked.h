// The interpreter's lock given up for a while.
#pragma once

#include <Python.h>
#include <chrono>
#include <cxxabi.h>
#include <thread>

namespace pliant {

[[noreturn]] inline void sleep_for_ever()
{
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

// Calls what runs code of Python, where an interpreter that ends unwinds the thread, too.
template <class Call> void call_python(const Call& call)
{
#ifdef __GLIBCXX__
    try {
        call();
    } catch (const abi::__forced_unwind&) {
        sleep_for_ever();
    }
#else
    call();
#endif
}

// Other threads of Python run while one of these lives. Of an interpreter that ends, CPython before 3.14 unwinds the threads
// that want its lock back, which ends the process where a destructor has to: they sleep here until the process is over, as
// they do in later versions.
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
