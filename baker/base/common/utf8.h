// Texts of strangers: what of them is UTF-8.
#pragma once

#include <cstddef>
#include <string_view>

namespace pliant {

// How many bytes at the beginning of `text` are one character of UTF-8; 0 if none is.
std::size_t character_length(std::string_view text);

} // namespace pliant
