// Work in processes of their own: what crashes or eats memory there harms nobody else.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace pliant {

// How a child ended.
struct ChildEnd {
    std::size_t id = 0;
    int exit_code = 0;      // if signal is 0
    int signal = 0;         // that killed it
    bool has_error = false; // it wrote a numbered error to standard error
    std::string output;     // what it wrote to standard output, the first MiB of it
    double seconds = 0;     // from start to end
    double peak_memory = 0; // bytes: the most that was resident
};

// Children that run this very program. Not thread-safe. If this process dies, however, its children end (on Linux).
class ChildGroup {
public:
    // A line that a child wrote to standard error, without its end.
    using LineSink = std::function<void(std::size_t id, const std::string& line)>;

    // `wake`: a descriptor that is readable once waiting is to stop; -1: none. `sink` is called inside wait() and stop().
    ChildGroup(int wake, LineSink sink)
        : wake_(wake)
        , sink_(std::move(sink))
    {
    }
    ~ChildGroup();
    ChildGroup(const ChildGroup&) = delete;
    ChildGroup& operator=(const ChildGroup&) = delete;

    // Runs the program with these arguments; nothing to read on standard input. Throws Failure (failed, P4601).
    void start(std::size_t id, const std::vector<std::string>& arguments);
    std::size_t running_count() const { return children_.size(); }

    // Returns when a child has ended, with all that have; with none if there is none, or as soon as `wake` is readable.
    std::vector<ChildEnd> wait();

    // Asks all to end (SIGTERM), kills them after five seconds, and waits until they have ended.
    std::vector<ChildEnd> stop();

private:
    struct Child {
        std::size_t id;
        pid_t pid;
        int output, errors; // descriptors to read from; -1: at its end
        std::string collected, line;
        std::chrono::steady_clock::time_point start;
        bool has_error = false;
    };

    bool read_all_ready(int wake, int timeout_ms);
    void read_output(Child& child);
    void read_errors(Child& child);
    void take_line(Child& child);
    std::vector<ChildEnd> collect_ended();

    int wake_;
    LineSink sink_;
    std::vector<Child> children_;
};

} // namespace pliant
