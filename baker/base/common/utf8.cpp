#include "base/common/utf8.h"

#include <cstdint>

namespace pliant {

std::size_t character_length(std::string_view text)
{
    const auto byte = [&](std::size_t i) { return i < text.size() ? std::uint8_t(text[i]) : 0u; };
    const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80; };
    const unsigned first = byte(0), second = byte(1);
    if (first < 0x80) return 1;
    if (first >= 0xC2 && first < 0xE0) return follows(1) ? 2 : 0;
    if (first >= 0xE0 && first < 0xF0) { // neither longer than need be nor half of a pair of UTF-16
        const bool is_good = (first != 0xE0 || second >= 0xA0) && (first != 0xED || second < 0xA0);
        return is_good && follows(1) && follows(2) ? 3 : 0;
    }
    if (first >= 0xF0 && first < 0xF5) {
        const bool is_good = (first != 0xF0 || second >= 0x90) && (first != 0xF4 || second < 0x90);
        return is_good && follows(1) && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

} // namespace pliant
