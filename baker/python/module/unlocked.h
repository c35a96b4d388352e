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

// To be made where code of Python is called, behind all objects of Python: of an interpreter that ends, the thread is
// unwound there, too, and must not go on to count references. No catch does it: none works within another one, as
// nanobind's is.
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
