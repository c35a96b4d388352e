#include "cli/console.h"

#include "base/common/print.h"
#include "input/io/write_file.h"

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/core.h>
#include <mutex>
#include <poll.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace pliant {

namespace {

// Held while outputs are tried or written, so that an interrupt comes before it or after it.
std::mutex& output_mutex()
{
    static std::mutex instance;
    return instance;
}

std::size_t written_count = 0; // outputs that are whole; under output_mutex
std::atomic<const char*> working_verb { "" };

// The end to write to once somebody wants to be told; -1 before.
std::atomic<int> interrupt_pipe { -1 };

std::string written_text()
{
    if (written_count == 0) return "nothing was written";
    return written_count == 1 ? "one file was written, whole"
                              : fmt::format("{} files were written, each whole", written_count);
}

// Nothing is unwound, since nothing half-done can be seen from outside.
[[noreturn]] void end_interrupted()
{
    output_mutex().lock();
    const std::string text = fmt::format("{}pliant{}: interrupted, {}\n", ::isatty(STDERR_FILENO) ? "\n" : "",
                                         working_verb.load(), written_text());
    const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
    (void)ignored;
    ::_exit(int(ExitCode::interrupted));
}

// nohup ignores the end of the terminal, which has to stay so: a signal that is awaited is no longer ignored.
bool is_ignored(int number)
{
    struct sigaction action = {};
    return ::sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

} // namespace

std::string duration_text(double seconds)
{
    const auto whole = static_cast<long long>(std::llround(seconds));
    if (whole < 60) return fmt::format("{} s", whole);
    return fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

ConsoleProgress::ConsoleProgress(std::string verb, const Talk& talk)
    : verb_(std::move(verb))
    , talk_(talk)
    , is_terminal_(::isatty(STDERR_FILENO) != 0)
{
}

ConsoleProgress::~ConsoleProgress() { clear_line(); }

void ConsoleProgress::clear_line()
{
    if (has_line_) std::fputs("\r\033[K", stderr);
    has_line_ = false;
}

void ConsoleProgress::update(const std::string& stage, double fraction, const std::string& detail)
{
    if (talk_.is_quiet) return;
    if (stage != stage_) {
        stage_ = stage;
        last_draw_ = {};
        if (talk_.is_verbose || !is_terminal_) print_stage(fraction);
    }
    if (is_terminal_) draw(fraction, detail);
}

void ConsoleProgress::print_stage(double fraction)
{
    clear_line();
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    print_to(stderr, "pliant {}: {} {:.0f} %{}\n", verb_, stage_, std::floor(100 * fraction),
             talk_.is_verbose ? fmt::format(" after {:.1f} s", elapsed) : "");
}

void ConsoleProgress::draw(double fraction, const std::string& detail)
{
    const Clock::time_point now = Clock::now();
    // Ten times a second is enough for the eye and costs nothing.
    if (now - last_draw_ < std::chrono::milliseconds(100)) return;
    last_draw_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    std::string line = fmt::format("\r\033[Kpliant {}: {} {:.0f} %", verb_, stage_, std::floor(100 * fraction));
    if (fraction > 0.05 && elapsed > 1) line += ", " + duration_text(elapsed * (1 - fraction) / fraction) + " left";
    if (!detail.empty()) line += " (" + detail + ")";
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
    has_line_ = true;
}

void ConsoleProgress::warn(int number, const std::string& what, const std::string& hint)
{
    clear_line();
    warnings_.push_back(warning_at(number, "", what, hint));
    print_finding(verb_, warnings_.back());
}

void print_finding(const std::string& verb, const Diagnostic& diagnostic)
{
    print_to(stderr, "pliant{}{}: {}\n", verb.empty() ? "" : " ", verb, to_text(diagnostic));
}

// Opened the wrong way round, so that reading and writing fail.
void open_closed_streams()
{
    for (int descriptor : { STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO })
        if (::fcntl(descriptor, F_GETFD) < 0) ::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

bool flush_output()
{
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return true;
    struct stat output = {};
    pollfd reader { STDOUT_FILENO, 0, 0 };
    // Of a terminal that has ended isatty() says that it is none.
    const bool is_device = ::fstat(STDOUT_FILENO, &output) != 0 || S_ISCHR(output.st_mode);
    if (!is_device && ::poll(&reader, 1, 0) == 1 && (reader.revents & POLLERR)) {
        std::signal(SIGPIPE, SIG_DFL);
        std::raise(SIGPIPE);
    }
    return false;
}

static bool has_avx2()
{
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

static bool set_if_unset(const char* name, const char* value)
{
    const char* const given = std::getenv(name);
    return (!given || !*given) && ::setenv(name, value, 1) == 0;
}

void start_with_fixed_blas(char** arguments)
{
    bool is_changed = set_if_unset("OPENBLAS_NUM_THREADS", "1");
    if (has_avx2()) is_changed |= set_if_unset("OPENBLAS_CORETYPE", "Haswell");
    if (!is_changed) return;
    ::execv("/proc/self/exe", arguments); // returns only if it failed: then all works but for signals during an analysis
}

void name_interrupts(const std::string& verb)
{
    static std::string name;
    name = " " + verb;
    working_verb = name.c_str();
}

// A thread waits for the signals, and all others, which inherit the mask, never see them: METIS puts a handler of its own on
// SIGTERM while it works, which jumps back into METIS from whatever thread it hits.
void install_signal_handlers()
{
    static sigset_t awaited;
    sigemptyset(&awaited);
    sigaddset(&awaited, SIGINT);
    sigaddset(&awaited, SIGTERM);
    if (!is_ignored(SIGHUP)) sigaddset(&awaited, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &awaited, nullptr);
    std::thread([] {
        for (;;) {
            int number = 0;
            while (sigwait(&awaited, &number) != 0) {}
            const int told = interrupt_pipe;
            if (told < 0) end_interrupted();
            const ssize_t ignored = ::write(told, "!", 1);
            (void)ignored;
        }
    }).detach();
    signal(SIGXFSZ, SIG_IGN); // a file-size limit is then an error of write(), which we report
    signal(SIGCHLD, SIG_DFL); // inherited as ignored it would hide how children end
    signal(SIGPIPE, SIG_IGN); // a reader of messages that is gone ends no bake
}

int catch_interrupts()
{
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0)
        throw Failure(ExitCode::failed, error_at(4601, "", "a pipe cannot be created", "close other programs"));
    interrupt_pipe = ends[1];
    return ends[0];
}

void try_outputs(const std::vector<std::string>& paths, const std::vector<std::string>& inputs)
{
    const std::lock_guard<std::mutex> lock(output_mutex());
    probe_outputs(paths, inputs);
}

void write_output(const std::string& path, std::string_view bytes)
{
    const std::lock_guard<std::mutex> lock(output_mutex());
    write_file_atomically(path, bytes);
    ++written_count;
}

} // namespace pliant
