#include "pipeline/child_process.h"

#include "base/common/diagnostics.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#ifdef __linux__
#include <sys/prctl.h>
#endif

namespace pliant {
namespace {

constexpr const char* this_program = "/proc/self/exe";
constexpr std::size_t output_limit = 1 << 20;
constexpr std::size_t line_limit = 1 << 16; // longer ones are told in pieces
constexpr std::chrono::seconds patience { 5 };

[[noreturn]] void fail_to_start(const char* what)
{
    throw Failure(ExitCode::failed,
                  error_at(4601, "", fmt::format("a process cannot be started: {}: {}", what, std::strerror(errno)),
                           "lower --jobs, or close other programs"));
}

struct Pipe {
    int read_end = -1, write_end = -1;
    Pipe()
    {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0) fail_to_start("pipe");
        read_end = ends[0];
        write_end = ends[1];
    }
    ~Pipe()
    {
        if (read_end >= 0) ::close(read_end);
        if (write_end >= 0) ::close(write_end);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    int take_read_end()
    {
        ::fcntl(read_end, F_SETFL, O_NONBLOCK);
        return std::exchange(read_end, -1);
    }
};

// Between fork and exec: only functions that are safe there, as the other threads of the parent are gone with what they held
// locked.
[[noreturn]] void become_program(char* const* arguments, int output, int errors, pid_t parent)
{
#ifdef __linux__
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(127); // it died before the line above
#else
    (void)parent;
#endif
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr); // the parent's threads have signals blocked
    const int nothing = ::open("/dev/null", O_RDONLY);
    if (nothing >= 0) ::dup2(nothing, STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(errors, STDERR_FILENO);
    ::execv(this_program, arguments);
    ::_exit(127);
}

// Reads what is there; false at the end of the pipe.
template <class Take> bool drain(int descriptor, const Take& take)
{
    std::array<char, 4096> buffer;
    for (;;) {
        const ssize_t got = ::read(descriptor, buffer.data(), buffer.size());
        if (got > 0)
            take(std::string_view(buffer.data(), std::size_t(got)));
        else if (got == 0)
            return false;
        else if (errno != EINTR)
            return errno == EAGAIN;
    }
}

} // namespace

ChildGroup::~ChildGroup()
{
    for (Child& child : children_) {
        ::kill(child.pid, SIGKILL);
        ::waitpid(child.pid, nullptr, 0);
        if (child.output >= 0) ::close(child.output);
        if (child.errors >= 0) ::close(child.errors);
    }
}

void ChildGroup::start(std::size_t id, const std::vector<std::string>& arguments)
{
    std::vector<std::string> words = { "pliant" };
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    Pipe output, errors;
    const pid_t parent = ::getpid();
    const pid_t pid = ::fork();
    if (pid < 0) fail_to_start("fork");
    if (pid == 0) become_program(argv.data(), output.write_end, errors.write_end, parent);
    children_.push_back(
        { id, pid, output.take_read_end(), errors.take_read_end(), {}, {}, std::chrono::steady_clock::now() });
}

void ChildGroup::read_output(Child& child)
{
    const bool goes_on = drain(child.output, [&](std::string_view bytes) {
        child.collected += bytes.substr(0, output_limit - std::min(output_limit, child.collected.size()));
    });
    if (goes_on) return;
    ::close(child.output);
    child.output = -1;
}

void ChildGroup::take_line(Child& child)
{
    child.has_error |= child.line.find("error P") != std::string::npos;
    sink_(child.id, child.line);
}

void ChildGroup::read_errors(Child& child)
{
    const bool goes_on = drain(child.errors, [&](std::string_view bytes) {
        for (const char c : bytes) {
            if (c != '\n' && child.line.size() < line_limit) {
                child.line += c;
                continue;
            }
            take_line(child);
            child.line = c == '\n' ? "" : std::string(1, c);
        }
    });
    if (goes_on) return;
    if (!child.line.empty()) take_line(child);
    ::close(child.errors);
    child.errors = -1;
}

// Waits for something to read and reads it. False if `wake` was readable.
bool ChildGroup::read_all_ready(int wake, int timeout_ms)
{
    std::vector<pollfd> polled = { { wake, POLLIN, 0 } }; // a negative descriptor is passed over
    for (const Child& child : children_) {
        polled.push_back({ child.output, POLLIN, 0 });
        polled.push_back({ child.errors, POLLIN, 0 });
    }
    if (::poll(polled.data(), polled.size(), timeout_ms) <= 0) return true;
    for (std::size_t i = 0; i < children_.size(); ++i) {
        if (polled[1 + 2 * i].revents != 0) read_output(children_[i]);
        if (polled[2 + 2 * i].revents != 0) read_errors(children_[i]);
    }
    return polled[0].revents == 0;
}

// A child has ended once both its pipes have: it may have closed them a moment before.
std::vector<ChildEnd> ChildGroup::collect_ended()
{
    std::vector<ChildEnd> ended;
    for (std::size_t i = 0; i < children_.size();) {
        Child& child = children_[i];
        if (child.output >= 0 || child.errors >= 0) {
            ++i;
            continue;
        }
        int status = 0;
        rusage usage {};
        pid_t waited = 0;
        while ((waited = ::wait4(child.pid, &status, 0, &usage)) < 0 && errno == EINTR) {}
        ChildEnd end;
        end.id = child.id;
        end.exit_code = waited < 0 ? int(ExitCode::failed) : WIFEXITED(status) ? WEXITSTATUS(status) : 0;
        end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        end.has_error = child.has_error;
        end.output = std::move(child.collected);
        end.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - child.start).count();
        end.peak_memory = double(usage.ru_maxrss) * 1024;
        ended.push_back(std::move(end));
        children_.erase(children_.begin() + std::ptrdiff_t(i));
    }
    return ended;
}

std::vector<ChildEnd> ChildGroup::wait()
{
    while (!children_.empty()) {
        if (!read_all_ready(wake_, -1)) return {};
        std::vector<ChildEnd> ended = collect_ended();
        if (!ended.empty()) return ended;
    }
    return {};
}

std::vector<ChildEnd> ChildGroup::stop()
{
    for (const Child& child : children_) ::kill(child.pid, SIGTERM);
    std::vector<ChildEnd> all;
    const auto end_of_patience = std::chrono::steady_clock::now() + patience;
    bool is_killed = false;
    while (!children_.empty()) {
        if (!is_killed && std::chrono::steady_clock::now() > end_of_patience) {
            for (const Child& child : children_) ::kill(child.pid, SIGKILL);
            is_killed = true;
        }
        read_all_ready(-1, 100);
        for (ChildEnd& end : collect_ended()) all.push_back(std::move(end));
    }
    return all;
}

} // namespace pliant
