// JSON that anyone may have written.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace pliant {

// Whether parsing it costs little: nested no deeper than any JSON of ours, which would eat the stack, and with fewer keys
// than would take quadratic time in an object that keeps their order.
inline bool is_simple_json(const std::string& text)
{
    constexpr int deepest = 32, most_keys = 20000;
    int depth = 0, keys = 0;
    bool is_in_text = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"') is_in_text = !is_in_text;
        if (is_in_text) {
            if (c == '\\') ++i;
            continue;
        }
        depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
        keys += c == ':';
        if (depth > deepest || keys > most_keys) return false;
    }
    return true;
}

// Discarded (is_discarded()) if `text` is no JSON, or not simple.
inline nlohmann::ordered_json parse_foreign_json(const std::string& text)
{
    if (!is_simple_json(text)) return nlohmann::ordered_json::value_t::discarded;
    return nlohmann::ordered_json::parse(text, nullptr, false);
}

} // namespace pliant
