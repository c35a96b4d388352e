// Numbered messages: what went wrong, where, and what to do about it. One number, one meaning, for ever.
#pragma once

#include <cstdint>
#include <exception>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

// What the process exits with. Scripts rely on these.
enum class ExitCode : int {
    done = 0,
    failed = 1,           // something failed while working
    usage = 2,            // the command line is wrong
    bad_input = 3,        // an input file is wrong
    misses_tolerance = 4, // the asset misses the tolerance asked for
    interrupted = 130
};

// One diagnostic. `number` is printed as P and four digits: P1xxx usage, P2xxx one input file, P3xxx poses against each
// other, P4xxx working, P5xxx assets. Warnings use the same numbers space. The table is in messages.md; a test compares it
// with the sources, and finds numbers by the three functions below, by Severity::..., and by Progress::warn.
struct Diagnostic {
    enum class Severity { warning, error };
    Severity severity = Severity::error;
    int number = 0;
    std::string where; // "run_04.obj:812", a file name, or empty
    std::string what;  // names the element (0-based index and as in the file) and the value
    std::string hint;  // what to do; may be empty
    // What it is about, numbered as in the pose files, for pictures: the first of them, at most element_limit each.
    std::vector<std::uint32_t> vertices {}, faces {};

    static constexpr std::size_t element_limit = 64;
};

// An error or a warning in one line of source: error_at(2103, where, what, hint).
Diagnostic error_at(int number, std::string where, std::string what, std::string hint = {});
Diagnostic warning_at(int number, std::string where, std::string what, std::string hint = {});

// The diagnostic with the elements that it is about.
Diagnostic about_vertices(Diagnostic diagnostic, const std::vector<std::uint32_t>& vertices);
Diagnostic about_faces(Diagnostic diagnostic, const std::vector<std::uint32_t>& faces);

// Stops a verb: carries everything found and the code to exit with.
class Failure : public std::exception {
public:
    Failure(ExitCode code, Diagnostic diagnostic);
    Failure(ExitCode code, std::vector<Diagnostic> diagnostics);

    ExitCode code() const { return code_; }
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }
    const char* what() const noexcept override; // all diagnostics as text, one after the other

private:
    ExitCode code_;
    std::vector<Diagnostic> diagnostics_;
    std::string text_;
};

// For terminals: control characters, which names of files and poses may hold, as \x1b; of more than 5,000 bytes the
// beginning.
std::string printable(std::string_view text);

// "error P2103: run_04.obj:812: face 377 uses vertex 9001, the file has 6890\n  hint: ..." (no verb in front, no final
// newline).
std::string to_text(const Diagnostic& diagnostic);

// Gathers diagnostics of many files so that one run tells everything, without a page per broken face: of every number the
// first
// `lines_per_number` are kept and the others counted. Memory does not grow with the number of diagnostics.
class DiagnosticList {
public:
    explicit DiagnosticList(std::size_t lines_per_number = 10)
        : lines_per_number_(lines_per_number)
    {
    }

    void add(Diagnostic diagnostic);
    bool has_errors() const { return error_count_ != 0; }
    std::size_t error_count() const { return error_count_; }

    // What was kept, in the order of arrival; behind the last of a number that overflowed stands "... and N more".
    std::vector<Diagnostic> diagnostics() const;

private:
    struct Overflow {
        std::size_t kept = 0;
        std::size_t dropped = 0;
        std::vector<std::string> dropped_files; // distinct, a few
        std::vector<std::uint32_t> vertices, faces;
    };
    std::size_t lines_per_number_;
    std::size_t error_count_ = 0;
    std::vector<Diagnostic> kept_;
    std::map<int, Overflow> numbers_;
};

} // namespace pliant
