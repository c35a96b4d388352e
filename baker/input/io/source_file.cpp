#include "input/io/source_file.h"

#include "base/common/memory.h"
#include "input/io/read_log.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <limits>
#include <new>
#include <sys/stat.h>
#include <unistd.h>

namespace pliant {
namespace {

// Squared lengths are formed in single precision by the runtime and must stay below 3.4e38.
constexpr double coordinate_limit = 1e18;

// A mesh at the limits of the asset format is smaller in every format but wordy text, and four times this fits into a
// workstation.
constexpr off_t file_size_limit = off_t(4) << 30;

struct FileDescriptor {
    int value = -1;
    ~FileDescriptor()
    {
        if (value >= 0) ::close(value);
    }
};

// Reads until the end or until the size told is there.
bool read_all(int descriptor, std::string& bytes)
{
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got = ::read(descriptor, &bytes[done], bytes.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return false;
        if (got == 0) break; // shorter than it said: the readers will call it truncated
        done += static_cast<std::size_t>(got);
    }
    bytes.resize(done);
    return true;
}

// from_chars says "out of range" for 1e400 and for 1e-400. The decimal exponent of the first digit tells them apart.
bool is_underflow(std::string_view word)
{
    std::int64_t position = 0; // of the next digit: digits before the point count up, behind it down
    std::int64_t leading = 0;
    bool seen_digit = false, seen_point = false;
    std::size_t i = 0;
    for (; i < word.size() && word[i] != 'e' && word[i] != 'E'; ++i) {
        if (word[i] == '.') seen_point = true;
        if (word[i] < '0' || word[i] > '9') continue;
        if (word[i] != '0') seen_digit = true;
        if (seen_point) --position;
        if (seen_digit && !seen_point) ++leading;
        if (seen_digit && seen_point && leading == 0) leading = position;
    }
    if (!seen_digit) return true; // 0e999
    if (i == word.size()) return leading < 0;
    const bool is_negative = i + 1 < word.size() && word[i + 1] == '-';
    const std::optional<std::int64_t> exponent = parse_integer(word.substr(i + 1));
    if (!exponent) return is_negative; // more digits than an integer has: its sign decides
    return *exponent < -leading;       // their sum may be too large for an integer
}

// std::from_chars takes no leading plus; one in front of a digit or a point is fine in all our formats.
std::string_view without_plus(std::string_view word)
{
    const bool has_plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
    return has_plus ? word.substr(1) : word;
}

std::optional<std::string> read_whole(const std::string& path, DiagnosticList& diagnostics)
{
    if (path.find('\0') != std::string::npos) { // the system would open the file of the name before it
        diagnostics.add(error_at(2001, path, "cannot be read: its name has a zero character", "name the file itself"));
        return std::nullopt;
    }
    // Without O_NONBLOCK opening a pipe would wait for a writer before we can see that it is one.
    FileDescriptor file { ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK) };
    struct stat status {};
    if (file.value < 0 || ::fstat(file.value, &status) != 0) {
        diagnostics.add(error_at(2001, path, fmt::format("cannot be read: {}", std::strerror(errno)),
                                 "check the name and the permissions of the file"));
        return std::nullopt;
    }
    if (!S_ISREG(status.st_mode)) {
        diagnostics.add(error_at(2002, path, S_ISDIR(status.st_mode) ? "is a folder" : "is not a regular file",
                                 "name a file on disk: folders, pipes and devices are not read"));
        return std::nullopt;
    }
    if (status.st_size > file_size_limit) {
        diagnostics.add(error_at(2008, path, fmt::format("has {} bytes, the limit is {}", status.st_size, file_size_limit),
                                 "simplify the mesh or use a binary format"));
        return std::nullopt;
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size > 0 && !has_room(size)) {
        diagnostics.add(error_at(2008, path, fmt::format("does not fit into memory: {} bytes", size),
                                 "use a machine with more memory or a coarser mesh"));
        return std::nullopt;
    }
    std::string bytes(size, '\0');
    if (read_all(file.value, bytes)) return bytes;
    diagnostics.add(error_at(2001, path, fmt::format("cannot be read: {}", std::strerror(errno)),
                             "check the disk or network drive that holds the file"));
    return std::nullopt;
}

} // namespace

void SourceFile::error(int number, std::string where, std::string what, std::string hint) const
{
    diagnostics->add({ Diagnostic::Severity::error, number, std::move(where), std::move(what), std::move(hint) });
}

std::optional<std::string> read_bytes(const std::string& path, DiagnosticList& diagnostics)
{
    const WriteTime written = write_time(path);
    std::optional<std::string> bytes = read_whole(path, diagnostics);
    note_reading(path, bytes, written);
    return bytes;
}

std::filesystem::path named_place(const std::string& path)
{
    std::filesystem::path place;
    std::error_code gone; // the current folder
    const std::filesystem::path whole = std::filesystem::absolute(path, gone);
    for (const std::filesystem::path& part : gone ? std::filesystem::path(path) : whole) {
        std::error_code error;
        if (part == "." || (part == ".." && place.has_filename() && place.filename() != ".." && !is_symlink(place, error))) {
            if (part == "..") place = place.parent_path();
            continue;
        }
        place /= part;
        if (part != "..") continue;
        const std::filesystem::path followed = std::filesystem::weakly_canonical(place, error);
        if (error == std::errc::not_enough_memory) throw std::bad_alloc();
        if (!error) place = followed;
    }
    return place.lexically_normal();
}

bool LineReader::next()
{
    if (offset_ >= text_.size()) return false;
    const std::string_view rest = text_.substr(offset_);
    const std::size_t length = std::min(rest.find_first_of("\r\n"), rest.size());
    line_ = rest.substr(0, length);
    offset_ += length;
    if (offset_ < text_.size()) offset_ += text_.substr(offset_, 2) == "\r\n" ? 2 : 1;
    ++number_;
    return true;
}

std::string_view next_word(std::string_view& line, char comment)
{
    const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
    line.remove_prefix(begin);
    if (line.empty() || (comment != '\0' && line[0] == comment)) {
        line = {};
        return {};
    }
    const std::size_t length = std::min(line.find_first_of(" \t"), line.size());
    const std::string_view word = line.substr(0, length);
    line.remove_prefix(length);
    return word;
}

std::optional<std::int64_t> parse_integer(std::string_view word)
{
    word = without_plus(word);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

std::string excerpt(std::string_view word)
{
    constexpr std::size_t limit = 24;
    std::string text = "'";
    for (const char c : word.substr(0, limit)) {
        if (c >= ' ' && c <= '~')
            text += c;
        else
            text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
    return text + (word.size() > limit ? "...'" : "'");
}

bool check_coordinate(const SourceFile& file, std::size_t line, std::size_t vertex, double value)
{
    if (!std::isfinite(value)) {
        const std::string text = std::isnan(value) ? "nan" : fmt::format("{}", value); // a nan has a sign that says nothing
        file.error(2105, file.at_line(line), fmt::format("vertex {} has the coordinate {}", vertex, text),
                   "the program that made the pose failed there: repair the pose");
        return false;
    }
    if (std::abs(value) > coordinate_limit) {
        file.error(2113, file.at_line(line),
                   fmt::format("vertex {} has the coordinate {:g}, beyond {:g}", vertex, value, coordinate_limit),
                   "use a larger unit of length");
        return false;
    }
    return true;
}

bool read_coordinate(const SourceFile& file, std::size_t line, std::size_t vertex, std::string_view word, double& value)
{
    const std::string_view number = without_plus(word);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    const bool is_whole = end == number.data() + number.size();
    if (error == std::errc() && is_whole) {
        if (std::abs(value) <= coordinate_limit) return true;
        return check_coordinate(file, line, vertex, value);
    }
    if (error == std::errc::result_out_of_range && is_whole) {
        value = 0;
        if (is_underflow(number)) return true;
        file.error(2105, file.at_line(line), fmt::format("vertex {} has the coordinate {}", vertex, excerpt(word)),
                   "the program that made the pose failed there: repair the pose");
        return false;
    }
    const bool has_comma = word.find(',') != std::string_view::npos;
    file.error(2106, file.at_line(line),
               fmt::format("vertex {}: number {} not understood{}", vertex, excerpt(word),
                           has_comma ? "; decimal point expected" : ""),
               has_comma ? "export again with a decimal point (an English or C locale)" : "export the file again");
    return false;
}

bool check_count(const SourceFile& file, std::size_t line, const std::string& element, std::uint64_t count,
                 std::uint64_t limit, std::uint64_t bytes_left, std::uint64_t minimal_size)
{
    if (count > limit) {
        file.error(2007, file.at_line(line), fmt::format("declares {} {}, the limit is {}", count, element, limit),
                   "simplify the mesh, or repair the header");
        return false;
    }
    if (minimal_size != 0 && count > bytes_left / minimal_size) {
        file.error(2104, file.at_line(line),
                   fmt::format("declares {} {}, but the {} bytes that follow hold {} at most", count, element, bytes_left,
                               bytes_left / minimal_size),
                   "the file is cut off or its header is wrong: export it again");
        return false;
    }
    return true;
}

void report_truncated(const SourceFile& file, const std::string& what)
{
    file.error(2101, file.path, fmt::format("ends at byte {} inside {}", file.bytes.size(), what),
               "the file is cut off: export or copy it again");
}

void report_truncated(const SourceFile& file, const std::string& element, std::uint64_t index, std::uint64_t count)
{
    report_truncated(file, fmt::format("{} {} of {} declared", element, index, count));
}

void FaceBuilder::add_corner(std::size_t line, std::int64_t index, std::uint64_t vertex_count)
{
    const bool is_inside = index >= 0 && static_cast<std::uint64_t>(index) < vertex_count;
    if (!is_inside) {
        file_.error(2103, file_.at_line(line),
                    fmt::format("face {} uses vertex {}, the file has {}", face(), index, vertex_count),
                    "vertices are missing or the face is wrong: export the file again");
    }
    // A file with an error is never used, so it does not matter what stands in for a bad index.
    mesh_.faces.indices.push_back(is_inside ? static_cast<std::uint32_t>(index) : 0);
}

void FaceBuilder::end_face(std::size_t line)
{
    const std::size_t corners = mesh_.faces.indices.size() - mesh_.faces.offsets.back();
    if (corners < 3) {
        file_.error(2108, file_.at_line(line), fmt::format("face {} has {} corners", face(), corners),
                    "remove points and lines from the mesh before you export it");
    }
    abandon_face(line);
}

void FaceBuilder::abandon_face(std::size_t line)
{
    mesh_.faces.offsets.push_back(static_cast<std::uint32_t>(mesh_.faces.indices.size()));
    if (line != 0) mesh_.face_lines.push_back(static_cast<std::uint32_t>(std::min<std::size_t>(line, UINT32_MAX)));
}

} // namespace pliant
