#include "input/gltf/uri.h"

#include <algorithm>
#include <cstdint>

namespace pliant {
namespace {

int base64_digit(char c)
{
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    return c == '/' ? 63 : -1;
}

int hex_digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

std::optional<std::string> decode_base64(std::string_view text)
{
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() % 4 == 1) return std::nullopt;
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int bit_count = 0;
    for (const char c : text) {
        const int digit = base64_digit(c);
        if (digit < 0) return std::nullopt;
        bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xffffff;
        bit_count += 6;
        if (bit_count < 8) continue;
        bit_count -= 8;
        bytes.push_back(static_cast<char>(bits >> bit_count & 0xff));
    }
    return bytes;
}

} // namespace

bool is_data_uri(std::string_view uri) { return uri.substr(0, 5) == "data:"; }

std::optional<std::string> decode_data_uri(std::string_view uri)
{
    constexpr std::string_view marker = ";base64,";
    const std::size_t comma = uri.find(',');
    if (!is_data_uri(uri) || comma == std::string_view::npos || comma + 1 < marker.size()) return std::nullopt;
    if (uri.substr(comma + 1 - marker.size(), marker.size()) != marker) return std::nullopt;
    return decode_base64(uri.substr(comma + 1));
}

std::optional<std::string> decode_file_uri(std::string_view uri)
{
    constexpr std::size_t longest = 4096;       // of a path on Linux
    constexpr std::ptrdiff_t most_folders = 16; // looking one up takes time with the square of their number
    if (uri.size() > longest) return std::nullopt;
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            name.push_back(uri[i]);
            continue;
        }
        const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1,
                  low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
        if (high < 0 || low < 0) return std::nullopt;
        name.push_back(static_cast<char>(high * 16 + low));
        i += 2;
    }
    if (name.empty() || name[0] == '/' || std::count(name.begin(), name.end(), '/') > most_folders) return std::nullopt;
    for (const char c : name)
        if (static_cast<unsigned char>(c) < ' ' || c == '\\') return std::nullopt;
    // A colon before the first slash makes it a scheme, or a drive.
    if (name.find(':') < name.find('/')) return std::nullopt;
    std::size_t start = 0;
    while (start <= name.size()) {
        const std::size_t end = std::min(name.find('/', start), name.size());
        if (name.compare(start, end - start, "..") == 0) return std::nullopt;
        start = end + 1;
    }
    return name;
}

} // namespace pliant
