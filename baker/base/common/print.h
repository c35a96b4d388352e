// What the tool says, on standard output and standard error.
#pragma once

#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <utility>

namespace pliant {

// As fmt::print, but never throws for the stream's sake: work goes on where a log cannot be written. Whether standard output
// was written is asked once, at the end (P4903).
template <class... Arguments>
void print_to(std::FILE* stream, fmt::format_string<Arguments...> format, Arguments&&... arguments)
{
    const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
    std::fwrite(text.data(), 1, text.size(), stream);
}

} // namespace pliant
