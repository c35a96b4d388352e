#include "work.h"

#include "unlocked.h"

#include "base/common/parallel.h"
#include "base/common/per_process.h"

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <memory>
#include <mutex>
#include <nanobind/stl/string.h>
#include <pthread.h>
#include <stdexcept>
#include <thread>
#include <unistd.h>
#include <vector>

namespace nb = nanobind;

namespace pliant {
namespace {

// Twenty looks a second: Ctrl-C and progress seem immediate, and the waiting costs nothing.
constexpr std::chrono::milliseconds look_interval { 50 };

struct Step {
    std::string stage;
    double done;
};

struct Warning {
    int number;
    std::string what, hint;
};

// Carries news from the working thread to the one that waits, and the order to stop back.
class Relay final : public Progress {
public:
    void update(const std::string& stage, double fraction, const std::string&) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (is_cancelled_) throw Interrupted();
        if (steps_.empty() || steps_.back().stage != stage)
            steps_.push_back({ stage, fraction });
        else
            steps_.back().done = fraction; // Python hears the last one of each stage
    }

    void warn(int number, const std::string& what, const std::string& hint) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        warnings_.push_back({ number, what, hint });
    }

    void cancel()
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        is_cancelled_ = true;
    }

    // Throws python_error if the listener raises.
    void deliver(const Listener& listener)
    {
        std::vector<Step> steps;
        std::vector<Warning> warnings;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            steps.swap(steps_);
            warnings.swap(warnings_);
        }
        for (const Warning& warning : warnings) listener.warn(warning.number, warning.what, warning.hint);
        if (listener.progress.is_none()) return;
        for (const Step& step : steps) listener.progress(step.stage, step.done, 1.0);
    }

private:
    std::mutex mutex_;
    std::vector<Step> steps_;
    std::vector<Warning> warnings_;
    bool is_cancelled_ = false;
};

void check_signals()
{
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

// METIS puts a handler of its own on SIGTERM while it works, which jumps back into METIS from whatever thread it hits. So
// the signal waits until the work has been stopped; the working thread inherits the mask. Threads of other libraries do not
// have it (README, "SIGTERM").
class TerminationHold {
public:
    TerminationHold()
    {
        sigemptyset(&held_);
        sigaddset(&held_, SIGTERM);
        pthread_sigmask(SIG_BLOCK, &held_, &before_);
    }
    ~TerminationHold() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    TerminationHold(const TerminationHold&) = delete;
    TerminationHold& operator=(const TerminationHold&) = delete;

    bool has_come() const
    {
        sigset_t pending;
        return sigpending(&pending) == 0 && sigismember(&pending, SIGTERM) == 1;
    }

private:
    sigset_t held_, before_;
};

// Who works: one thread of the process at a time, in turns.
struct Turns {
    std::mutex mutex;
    std::condition_variable freed, ended;
    std::thread::id worker; // none: nobody
    Relay* relay = nullptr; // while a thread of our own works
};

Turns& turns() { return per_process<Turns>(); }

class Turn {
public:
    Turn()
    {
        while (!take()) check_signals();
    }
    ~Turn()
    {
        const std::lock_guard<std::mutex> lock(turns().mutex);
        turns().worker = {};
        turns().freed.notify_one();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

private:
    // Waits for a moment.
    static bool take()
    {
        const Unlocked unlocked;
        std::unique_lock<std::mutex> lock(turns().mutex);
        if (turns().worker == std::this_thread::get_id())
            throw std::runtime_error("this thread is at work already: what it calls back cannot start another work");
        if (!turns().freed.wait_for(lock, look_interval, [] { return turns().worker == std::thread::id(); })) return false;
        turns().worker = std::this_thread::get_id();
        return true;
    }
};

// A thread that works, and what came of it.
class Worker {
public:
    Worker(const std::function<void(Progress&)>& work, Relay& relay)
    {
        set_relay(&relay);
        try {
            thread_ = std::make_unique<std::thread>([this, &work, &relay] { run(work, relay); });
        } catch (...) { // the system is short of threads
            set_relay(nullptr);
            throw;
        }
    }

    // Of a child that a callback has forked, which has no worker, and whose locks may be taken for ever.
    bool is_elsewhere() const { return getpid() != process_; }

    // There. The handle must not be touched: another thread of the child may have the same by now.
    void forget() { [[maybe_unused]] const std::thread* leaked = thread_.release(); }

    // True when the work has ended; waits for that a moment.
    bool wait()
    {
        const Unlocked unlocked;
        std::unique_lock<std::mutex> lock(mutex_);
        if (!changed_.wait_for(lock, look_interval, [this] { return has_ended_; })) return false;
        lock.unlock();
        thread_->join();
        return true;
    }

    std::exception_ptr failure; // to be read after the end

private:
    static void set_relay(Relay* relay)
    {
        const std::lock_guard<std::mutex> lock(turns().mutex);
        turns().relay = relay;
        turns().ended.notify_one();
    }

    void run(const std::function<void(Progress&)>& work, Relay& relay)
    {
        try {
            work(relay);
        } catch (...) {
            failure = std::current_exception();
        }
        set_relay(nullptr);
        const std::lock_guard<std::mutex> lock(mutex_);
        has_ended_ = true;
        changed_.notify_one();
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    bool has_ended_ = false;
    pid_t process_ = getpid();
    std::unique_ptr<std::thread> thread_;
};

struct Terminated {};

void look(Relay& relay, const Listener& listener, const TerminationHold& hold)
{
    PythonCall call;
    check_signals();
    if (hold.has_come()) throw Terminated();
    relay.deliver(listener);
    call.has_ended = true;
}

// Waits for the end of the work in any case. Throws what stopped it, else what it threw itself.
void follow(const Listener& listener, const std::function<void(Progress&)>& work)
{
    const TerminationHold hold;
    Relay relay;
    Worker worker(work, relay);
    std::exception_ptr stop;
    bool has_ended = false;
    while (!has_ended && !worker.is_elsewhere()) {
        has_ended = worker.wait();
        if (stop) continue;
        try {
            look(relay, listener, hold);
        } catch (...) {
            stop = std::current_exception();
            if (!worker.is_elsewhere()) relay.cancel();
        }
    }
    if (!has_ended) {
        worker.forget();
        if (!stop) throw std::runtime_error("the work goes on in the process that this one is forked of");
    }
    if (stop) std::rethrow_exception(stop);
    if (worker.failure) std::rethrow_exception(worker.failure);
}

} // namespace

void end_work()
{
    constexpr std::chrono::seconds patience { 10 };
    std::unique_lock<std::mutex> lock(turns().mutex);
    if (turns().relay) turns().relay->cancel();
    turns().ended.wait_for(lock, patience, [] { return turns().relay == nullptr; });
}

void work_interruptibly(const Listener& listener, unsigned thread_count, const std::function<void(Progress&)>& work)
{
    const Turn turn;
    set_thread_count(thread_count);
    try {
        follow(listener, work);
    } catch (const Terminated&) { // the signal has been let through by now, and this process still lives
        check_signals();
        PyErr_SetString(PyExc_KeyboardInterrupt, "stopped by SIGTERM");
        throw nb::python_error();
    }
}

} // namespace pliant
