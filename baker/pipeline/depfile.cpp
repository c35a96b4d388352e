#include "pipeline/depfile.h"

#include "base/common/diagnostics.h"
#include "input/io/source_file.h"

#include <fmt/format.h>

namespace pliant {
namespace {

// What nothing escapes for Make and Ninja alike: ends of lines and of prerequisites. What follows a ';' Make runs, so a
// stranger's glTF file, which names others, could run a command in the build.
void check_name(const std::string& path)
{
    const std::size_t at = path.find_first_of("\r\n;|");
    if (at == std::string::npos && path.back() != '\\') return;
    const std::string what = at == std::string::npos ? "ends with a backslash"
        : path[at] < ' '                             ? "contains a line break"
                                                     : fmt::format("contains '{}'", path[at]);
    throw Failure(ExitCode::failed,
                  error_at(4604, "",
                           fmt::format("the name {} {}, which a dependency file cannot express", excerpt(path), what),
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
        if (c == ' ' || c == '\t' || c == '#') text += std::string(backslashes, '\\') + '\\';
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
