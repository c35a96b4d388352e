#include "pipeline/depfile.h"

#include "base/common/diagnostics.h"
#include "input/io/source_file.h"

#include <fmt/format.h>

namespace pliant {
namespace {

// GCC's rules, which Make, Ninja and CMake follow: a space or '#' takes a backslash, backslashes in front of it are doubled,
// others stand for themselves; '$' is doubled.
std::string escaped(const std::string& path)
{
    if (path.find_first_of("\r\n") != std::string::npos)
        throw Failure(
            ExitCode::failed,
            error_at(4604, "",
                     fmt::format("the name {} contains a line break, which a dependency file cannot express", excerpt(path)),
                     "rename it, or leave --depfile out"));
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
