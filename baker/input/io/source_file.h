// A file in memory, its lines and its numbers: what all readers share.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace pliant {

// A file while it is read: its bytes, and the place where diagnostics go.
struct SourceFile {
    std::string path;
    std::string bytes; // without a byte order mark
    DiagnosticList* diagnostics = nullptr;

    // "run.obj:812"; line 0 stands for a binary file and gives the path alone.
    std::string at_line(std::size_t line) const { return line == 0 ? path : path + ":" + std::to_string(line); }
    void error(int number, std::string where, std::string what, std::string hint = {}) const;
};

// The bytes of a regular file. Errors P2001 (cannot be read), P2002 (not a regular file), P2008 (memory): empty result.
std::optional<std::string> read_bytes(const std::string& path, DiagnosticList& diagnostics);

// Lines of a text, whether they end with LF, CR LF or CR; the last needs no end.
class LineReader {
public:
    explicit LineReader(std::string_view text)
        : text_(text)
    {
    }

    // Goes to the next line; false at the end of the text.
    bool next();
    std::string_view line() const { return line_; }
    std::size_t number() const { return number_; } // of the current line, from 1
    std::size_t offset() const { return offset_; } // of the byte behind the current line and its end

private:
    std::string_view text_;
    std::string_view line_;
    std::size_t number_ = 0;
    std::size_t offset_ = 0;
};

// Takes the next word (between spaces and tabs) off the front of a line; empty at its end or where `comment` begins.
std::string_view next_word(std::string_view& line, char comment = '\0');

// A whole word as an integer, nothing else in it. A leading plus is accepted.
std::optional<std::int64_t> parse_integer(std::string_view word);

// Where a file is, by its name, without "." and "..": links stay, since what they lead to may become another file. Those
// before ".." are followed, else it would lead elsewhere; unless the file system fails.
std::filesystem::path named_place(const std::string& path);

// A word for a message: at most 24 printable characters, in quotes.
std::string excerpt(std::string_view word);

// One coordinate of a vertex as text. Correctly rounded, independent of the locale; too small for a double becomes 0.
// Errors: P2105 not finite, P2106 not a number, P2113 too large.
bool read_coordinate(const SourceFile& file, std::size_t line, std::size_t vertex, std::string_view word, double& value);

// The same for a number that came as bytes (line 0).
bool check_coordinate(const SourceFile& file, std::size_t line, std::size_t vertex, double value);

// What an asset can hold (formats/SPEC.md, header).
constexpr std::uint64_t vertex_count_limit = std::uint64_t(1) << 26;
constexpr std::uint64_t face_count_limit = std::uint64_t(1) << 27;
// Corners of all faces together. There are fewer triangles than corners, and thrice their number must fit into 32 bits.
constexpr std::uint64_t corner_count_limit = 3 * face_count_limit;

// Counts from a header against the limits and against the bytes that are left: P2007, P2104. minimal_size: bytes of the
// smallest possible element.
bool check_count(const SourceFile& file, std::size_t line, const std::string& element, std::uint64_t count,
                 std::uint64_t limit, std::uint64_t bytes_left, std::uint64_t minimal_size);

// P2101 for a file that ends early: inside what, or inside which of how many elements.
void report_truncated(const SourceFile& file, const std::string& what);
void report_truncated(const SourceFile& file, const std::string& element, std::uint64_t index, std::uint64_t count);

// Faces as they arrive, with what every format asks of them.
class FaceBuilder {
public:
    FaceBuilder(const SourceFile& file, MeshFile& mesh)
        : file_(file)
        , mesh_(mesh)
    {
    }

    // Appends a corner. Index from 0, out of range is P2103. line 0: a binary file.
    void add_corner(std::size_t line, std::int64_t index, std::uint64_t vertex_count);
    // Ends the face; fewer than three corners are P2108.
    void end_face(std::size_t line);
    // Ends a face about which an error was reported.
    void abandon_face(std::size_t line);
    std::size_t face() const { return mesh_.faces.count(); }

private:
    const SourceFile& file_;
    MeshFile& mesh_;
};

// The readers proper. False if the file was left half read; errors are in file.diagnostics either way.
bool read_obj(const SourceFile& file, MeshFile& mesh);
bool is_obj_statement(std::string_view word); // whether a line of OBJ may begin with it
bool read_ply(const SourceFile& file, MeshFile& mesh);
bool read_off(const SourceFile& file, MeshFile& mesh);

} // namespace pliant
