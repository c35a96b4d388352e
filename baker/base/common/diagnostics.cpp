#include "base/common/diagnostics.h"

#include "base/common/utf8.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace pliant {
namespace {

// How many file names the line "... and N more in a, b, c" spells out.
constexpr std::size_t overflow_file_limit = 3;

// "run.obj:812" -> "run.obj"
std::string without_line(const std::string& where)
{
    const std::size_t colon = where.find_last_of(':');
    if (colon == std::string::npos || colon + 1 == where.size()) return where;
    const bool is_line = std::all_of(where.begin() + static_cast<std::ptrdiff_t>(colon) + 1, where.end(),
                                     [](unsigned char c) { return c >= '0' && c <= '9'; });
    return is_line ? where.substr(0, colon) : where;
}

void add_elements(const std::vector<std::uint32_t>& more, std::vector<std::uint32_t>& elements)
{
    for (const std::uint32_t element : more) {
        if (elements.size() >= Diagnostic::element_limit) return;
        if (std::find(elements.begin(), elements.end(), element) == elements.end()) elements.push_back(element);
    }
}

std::string join(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::string join(const std::vector<Diagnostic>& diagnostics)
{
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics) text += (text.empty() ? "" : "\n") + to_text(diagnostic);
    return text;
}

} // namespace

Diagnostic error_at(int number, std::string where, std::string what, std::string hint)
{
    return { Diagnostic::Severity::error, number, std::move(where), std::move(what), std::move(hint) };
}

Diagnostic warning_at(int number, std::string where, std::string what, std::string hint)
{
    return { Diagnostic::Severity::warning, number, std::move(where), std::move(what), std::move(hint) };
}

Diagnostic about_vertices(Diagnostic diagnostic, const std::vector<std::uint32_t>& vertices)
{
    add_elements(vertices, diagnostic.vertices);
    return diagnostic;
}

Diagnostic about_faces(Diagnostic diagnostic, const std::vector<std::uint32_t>& faces)
{
    add_elements(faces, diagnostic.faces);
    return diagnostic;
}

Failure::Failure(ExitCode code, Diagnostic diagnostic)
    : Failure(code, std::vector<Diagnostic> { std::move(diagnostic) })
{
}

Failure::Failure(ExitCode code, std::vector<Diagnostic> diagnostics)
    : code_(code)
    , diagnostics_(std::move(diagnostics))
    , text_(join(diagnostics_))
{
}

const char* Failure::what() const noexcept { return text_.c_str(); }

namespace {

// What moves a terminal's cursor, colours it, breaks a line, or turns the direction of what follows.
bool is_control(std::string_view character)
{
    const auto c = static_cast<unsigned char>(character[0]);
    if (character.size() == 1) return c < ' ' || c == 127;
    if (character.size() == 2) return c == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
    const auto is_between
        = [&](std::string_view first, std::string_view last) { return first <= character && character <= last; };
    return is_between("\u200E", "\u200F") || is_between("\u2028", "\u202E") || is_between("\u2066", "\u2069");
}

} // namespace

std::string printable(std::string_view text)
{
    constexpr std::size_t limit = 5000; // a path has at most 4,096 bytes
    if (text.size() > limit) return fmt::format("{}... ({} bytes)", printable(text.substr(0, limit)), text.size());
    std::string out;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
        text.remove_prefix(character.size());
        if (length != 0 && !is_control(character))
            out += character;
        else
            for (const char byte : character) out += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
    return out;
}

std::string to_text(const Diagnostic& diagnostic)
{
    std::string text = fmt::format("{} P{:04}: ", diagnostic.severity == Diagnostic::Severity::error ? "error" : "warning",
                                   diagnostic.number);
    if (!diagnostic.where.empty()) text += printable(diagnostic.where) + ": ";
    text += printable(diagnostic.what);
    if (!diagnostic.hint.empty()) text += "\n  hint: " + printable(diagnostic.hint);
    return text;
}

void DiagnosticList::add(Diagnostic diagnostic)
{
    if (diagnostic.severity == Diagnostic::Severity::error) ++error_count_;
    Overflow& overflow = numbers_[diagnostic.number];
    if (overflow.kept < lines_per_number_) {
        ++overflow.kept;
        kept_.push_back(std::move(diagnostic));
        return;
    }
    ++overflow.dropped;
    add_elements(diagnostic.vertices, overflow.vertices);
    add_elements(diagnostic.faces, overflow.faces);
    std::vector<std::string>& files = overflow.dropped_files;
    if (files.size() > overflow_file_limit) return;
    std::string file = without_line(diagnostic.where);
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(std::move(file));
}

std::vector<Diagnostic> DiagnosticList::diagnostics() const
{
    std::map<int, std::size_t> last; // index of the last kept diagnostic of each number
    for (std::size_t i = 0; i < kept_.size(); ++i) last[kept_[i].number] = i;

    std::vector<Diagnostic> all;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        const Diagnostic& diagnostic = kept_[i];
        const std::size_t last_index = last.at(diagnostic.number);
        all.push_back(diagnostic);
        // The same advice is given once, behind the last line of its kind.
        const std::size_t dropped = numbers_.at(diagnostic.number).dropped;
        const bool advice_follows = i != last_index ? diagnostic.hint == kept_[last_index].hint : dropped != 0;
        if (advice_follows) all.back().hint.clear();
        if (i != last_index || dropped == 0) continue;

        const Overflow& overflow = numbers_.at(diagnostic.number);
        std::vector<std::string> files = overflow.dropped_files;
        if (files.size() > overflow_file_limit) files[overflow_file_limit] = "...";
        const std::string what = fmt::format("... and {} more in {}", dropped, join(files));
        all.push_back(
            { diagnostic.severity, diagnostic.number, {}, what, diagnostic.hint, overflow.vertices, overflow.faces });
    }
    return all;
}

} // namespace pliant
