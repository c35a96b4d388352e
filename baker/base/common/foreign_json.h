// JSON that anyone may have written: what parsing it would cost is known before.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace pliant {

struct JsonShape {
    int nesting = 0;           // of brackets outside of texts, at the deepest
    std::size_t key_count = 0; // of the object that has most
    std::size_t memory = 0;    // bytes that the parsed values take, about
};

// Without recursion, and for any bytes.
JsonShape json_shape(std::string_view text);

// Discarded (is_discarded()) if `text` is no JSON, is nested deeper than any JSON of ours, or has an object of so many
// keys that keeping their order would take quadratic time.
nlohmann::ordered_json parse_foreign_json(const std::string& text);

} // namespace pliant
