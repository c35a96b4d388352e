// Text for a page: escaping, numbers with their units.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pliant {

// Text between tags and in quoted attributes, whatever it is: &, <, >, " and ' as references, control characters and bytes
// that are not UTF-8 as U+FFFD.
std::string escape_html(std::string_view text);

// A name of at most some 200 bytes, by whole characters: pages repeat it at every picture.
std::string shortened(const std::string& name);

// 0.00051 as "0.051 %", with two digits that count; "unknown" if it is not a number.
std::string percent_text(double part);

// 6574528 as "6,574,528".
std::string count_text(std::uint64_t count);

// "812 bytes", "38.2 KiB", "6.27 MiB".
std::string bytes_text(double bytes);

// "0.42 s", "12.1 s", "3 min 05 s".
std::string seconds_text(double seconds);

// A coordinate in a drawing: two decimals, never exponents.
std::string place_text(double place);

} // namespace pliant
