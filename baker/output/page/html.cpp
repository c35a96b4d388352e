#include "output/page/html.h"

#include "base/common/utf8.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {

namespace {

constexpr const char* replacement = "\xEF\xBF\xBD";

} // namespace

std::string shortened(const std::string& name)
{
    constexpr std::size_t longest = 200;
    std::size_t end = std::min(name.size(), longest);
    while (end > 0 && end < name.size() && (std::uint8_t(name[end]) & 0xC0u) == 0x80) --end;
    return end == name.size() ? name : name.substr(0, end) + "…";
}

std::string escape_html(std::string_view text)
{
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = character_length(text.substr(i));
        const unsigned char c = static_cast<unsigned char>(text[i]);
        if (length == 0 || c == 0x7F || (c < ' ' && c != '\n' && c != '\t'))
            out += replacement;
        else if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else if (c == '\'')
            out += "&#39;";
        else
            out += text.substr(i, length);
        i += std::max<std::size_t>(length, 1);
    }
    return out;
}

std::string percent_text(double part)
{
    if (!std::isfinite(part)) return "unknown";
    const double percent = 100 * part;
    if (percent == 0) return "0 %";
    if (std::abs(percent) < 1e-4 || std::abs(percent) >= 1e6) return fmt::format("{:.1e} %", percent);
    const int digits = std::clamp(1 - int(std::floor(std::log10(std::abs(percent)))), 0, 5);
    return fmt::format("{:.{}f} %", percent, digits);
}

std::string count_text(std::uint64_t count)
{
    std::string text = std::to_string(count);
    for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, ",");
    return text;
}

std::string bytes_text(double bytes)
{
    if (bytes < 1024) return fmt::format("{:.0f} bytes", bytes);
    if (bytes < 1048576) return fmt::format("{:.1f} KiB", bytes / 1024);
    return fmt::format("{:.2f} MiB", bytes / 1048576);
}

std::string seconds_text(double seconds)
{
    if (seconds < 9.95) return fmt::format("{:.2f} s", seconds);
    if (seconds < 99.95) return fmt::format("{:.1f} s", seconds);
    const double whole = std::round(seconds);
    return fmt::format("{:.0f} min {:02.0f} s", std::floor(whole / 60), std::fmod(whole, 60));
}

std::string place_text(double place)
{
    // Hostile numbers stay in the drawing's neighbourhood.
    return fmt::format("{:.2f}", std::isfinite(place) ? std::clamp(place, -1e5, 1e5) : 0.0);
}

} // namespace pliant
