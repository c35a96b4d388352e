#include "pipeline/depfile.h"

#include "base/common/diagnostics.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

namespace pliant {
namespace {

bool is_plain(char c)
{
    const bool is_letter_or_digit = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    return is_letter_or_digit || static_cast<unsigned char>(c) >= 0x80
        || std::string_view("+,/_.~(){}@!- #$\\").find(c) != std::string_view::npos;
}

// What Make and Ninja have no common escape for, empty if the name has nothing of it. A stranger's glTF file names others:
// Make runs what follows ';' or "!=", and takes a rule with '=', ':' or '%' for something else than a list of files; Ninja
// ends a name at any character that it does not know, and says nothing.
std::string forbidden_part(const std::string& path)
{
    const std::size_t drive = std::filesystem::path(path).root_name().native().size(); // C: on Windows
    for (std::size_t i = drive; i < path.size(); ++i) {
        const char c = path[i];
        if (c == '\n' || c == '\r') return "contains a line break";
        if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) return "contains a control character";
        if (!is_plain(c)) return fmt::format("contains '{}'", c);
    }
    if (path.front() == '~' || path.front() == '-') return fmt::format("begins with '{}'", path.front());
    if (path.back() == ')') return "ends with ')'";
    if (path.back() == ' ') return "ends with a space";
    return path.back() == '\\' ? "ends with a backslash" : "";
}

void check_name(const std::string& path)
{
    const std::string part = forbidden_part(path);
    if (part.empty()) return;
    throw Failure(ExitCode::failed,
                  error_at(4604, "",
                           fmt::format("the name '{}' {}, which a dependency file cannot express", printable(path), part),
                           "rename it, or leave --depfile out"));
}

// GCC's rules, which Make, Ninja and CMake follow: a space or '#' takes a backslash, backslashes in front of it are doubled,
// others stand for themselves; '$' is doubled.
std::string escaped(const std::string& path)
{
    check_name(path);
    std::string text;
    std::size_t backslashes = 0;
    for (const char c : path) {
        if (c == ' ' || c == '#') text += std::string(backslashes, '\\') + '\\';
        if (c == '$') text += '$';
        text += c;
        backslashes = c == '\\' ? backslashes + 1 : 0;
    }
    return text;
}

} // namespace

std::string write_depfile(const std::string& target, const std::vector<std::string>& files)
{
    std::string text = escaped(target) + ":";
    for (const std::string& file : files) text += " \\\n  " + escaped(file);
    return text + "\n";
}

} // namespace pliant
