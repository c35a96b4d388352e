#include "base/common/foreign_json.h"

#include <algorithm>
#include <array>

namespace pliant {

// A map and its nodes, the items of a list that grows by halves, texts.
JsonShape json_shape(std::string_view text)
{
    JsonShape shape;
    shape.memory = text.size();
    int depth = 0;
    std::array<std::size_t, 64> key_counts {}; // of the objects that are open; deeper ones share the last
    const auto count_at = [&]() -> std::size_t& { return key_counts[std::size_t(std::clamp(depth, 0, 63))]; };
    bool is_in_text = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (is_in_text) {
            if (c == '\\') ++i;
            is_in_text = c != '"';
        } else if (c == '"') {
            is_in_text = true;
            shape.memory += 32;
        } else if (c == '{' || c == '[') {
            shape.nesting = std::max(shape.nesting, ++depth);
            count_at() = 0;
            shape.memory += 64;
        } else if (c == '}' || c == ']') {
            --depth;
        } else if (c == ':') {
            shape.key_count = std::max(shape.key_count, ++count_at());
            shape.memory += 64;
        } else if (c == ',') {
            shape.memory += 32;
        }
    }
    return shape;
}

nlohmann::ordered_json parse_foreign_json(const std::string& text)
{
    constexpr int deepest = 32;
    constexpr std::size_t most_keys = 1000;
    if (text.find('\0') != std::string::npos) return nlohmann::ordered_json::value_t::discarded; // would end the parse
    const JsonShape shape = json_shape(text);
    if (shape.nesting > deepest || shape.key_count > most_keys) return nlohmann::ordered_json::value_t::discarded;
    return nlohmann::ordered_json::parse(text, nullptr, false);
}

} // namespace pliant
