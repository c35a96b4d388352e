// What the command line says while it works, and how it ends.
#pragma once

#include "base/common/diagnostics.h"
#include "base/common/progress.h"

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

// How much a verb says: -q, -v.
struct Talk {
    bool is_quiet = false, is_verbose = false;
};

// Prints progress to stderr: one line redrawn with stage, percentage of the whole work and remaining time on a terminal, a
// plain line per stage elsewhere or when verbose, then with the seconds so far; nothing but warnings when quiet.
class ConsoleProgress final : public Progress {
public:
    ConsoleProgress(std::string verb, const Talk& talk);
    ~ConsoleProgress() override;

    void update(const std::string& stage, double fraction, const std::string& detail = {}) override;
    void warn(int number, const std::string& what, const std::string& hint = {}) override;
    void clear_line();

    const std::vector<Diagnostic>& warnings() const { return warnings_; } // all so far

private:
    using Clock = std::chrono::steady_clock;
    void print_stage(double fraction);
    void draw(double fraction, const std::string& detail);

    std::string verb_, stage_;
    Talk talk_;
    bool is_terminal_, has_line_ = false;
    Clock::time_point start_ = Clock::now(), last_draw_;
    std::vector<Diagnostic> warnings_;
};

// "42 s", "3 min 05 s".
std::string duration_text(double seconds);

// "pliant bake: error P2103: ..." with its hint, to stderr.
void print_finding(const std::string& verb, const Diagnostic& diagnostic);

// Gives the descriptors 0, 1 and 2 to nothing where they are closed, so that no file or pipe that is opened later gets them.
// What is written there is lost, and flush_output() says so. Call first.
void open_closed_streams();

// False if something that was printed on standard output could not be written. Ends the process, as any other program in a
// pipe, if its reader is gone.
bool flush_output();

// OpenBLAS starts its threads and chooses its kernels before main. Unless the environment sets both, starts the program
// again with one thread, since no signal mask reaches the others, and on x86 processors with AVX2 with the kernels for
// those: an OpenBLAS older than the processor takes much slower ones, and other kernels change the last bits of a bake.
void start_with_fixed_blas(char** arguments);

// Ctrl-C, SIGTERM and, unless nohup has it ignored, SIGHUP end the process with exit code 130 at once. That is safe: outputs
// exist under their own name only when they are whole, and while one is written the signal waits until its temporary file is
// gone or has its name.
void install_signal_handlers();

// The verb that an interrupt names. To be called once.
void name_interrupts(const std::string& verb);

// From now on these signals end nothing, but make the descriptor that is returned readable, for verbs that have to
// clean up.
int catch_interrupts();

// probe_outputs (input/io/write_file.h), with the signals held back meanwhile.
void try_outputs(const std::vector<std::string>& paths, const std::vector<std::string>& inputs);

// write_file_atomically, with the signals held back meanwhile; an interrupt later says how many were written.
void write_output(const std::string& path, std::string_view bytes);

} // namespace pliant
