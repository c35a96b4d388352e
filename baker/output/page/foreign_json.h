// JSON that anyone may have written.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace pliant {

// What is nested deeper than any JSON of ours is left out: it would eat the stack. Discarded (is_discarded()) if `text` is
// no JSON.
inline nlohmann::ordered_json parse_foreign_json(const std::string& text)
{
    constexpr int deepest = 32;
    const auto is_kept = [](int depth, auto, nlohmann::ordered_json&) { return depth < deepest; };
    return nlohmann::ordered_json::parse(text, is_kept, false);
}

} // namespace pliant
