// Command lines to copy.
#pragma once

#include <string>

namespace pliant {

// The text as a POSIX shell takes it for one word, whatever it is; with control characters or broken UTF-8 as $'...', which
// shells have that follow POSIX of 2024, bash and zsh among them.
std::string shell_word(const std::string& text);

} // namespace pliant
