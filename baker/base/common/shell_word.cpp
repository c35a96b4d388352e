#include "base/common/shell_word.h"

#include "base/common/diagnostics.h"

namespace pliant {

std::string shell_word(const std::string& text)
{
    const char* const plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
    const bool is_printable = printable(text) == text;
    std::string out;
    for (char c : text) {
        if (c == '\'') out += is_printable ? "'\\'" : "\\";
        if (c == '\\' && !is_printable) out += "\\";
        out += c;
    }
    return is_printable ? "'" + out + "'" : "$'" + printable(out) + "'";
}

} // namespace pliant
