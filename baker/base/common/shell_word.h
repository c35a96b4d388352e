// Command lines to copy.
#pragma once

#include <string>

namespace pliant {

// The text as a POSIX shell takes it for one word, whatever it is.
std::string shell_word(const std::string& text);

} // namespace pliant
