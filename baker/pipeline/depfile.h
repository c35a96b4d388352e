// Dependency files, as Make and Ninja read them.
#pragma once

#include <string>
#include <vector>

namespace pliant {

// "target: file file ...": one rule, a file a line. Spaces, '#', '$' and backslashes are escaped in the way that both
// programs (and CMake) understand. Throws Failure (failed, P4604) for a name that one of them would take for something else.
std::string write_depfile(const std::string& target, const std::vector<std::string>& files);

} // namespace pliant
