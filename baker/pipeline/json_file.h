// JSON that people write by hand: configurations and manifests.
#pragma once

#include "base/common/diagnostics.h"
#include "base/common/nearest_word.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pliant {

using Json = nlohmann::ordered_json;

// A file whose whole text is one JSON object. Throws Failure (bad_input): P2001, P2002, P2008 (it cannot be read), P2701
// (not JSON, with line and column, or no object), P2702 (nested deeper than 32), P2703 (a key twice in one object).
Json read_json_file(const std::string& path);

// The error about a key that nobody knows, P2704: names the nearest one of `known` or, if none is near, all.
[[noreturn]] void fail_unknown_key(const std::string& where, const std::string& key, const std::vector<std::string>& known);

// JSON to be read by people and programs; bytes of file names that are not UTF-8 are replaced.
std::string json_text(const Json& json);

// "a number", "a string", ...: what a value is, for messages.
std::string kind_of(const Json& value);

// What `value`, whose place is `where` + `key`, must be: P2705.
[[noreturn]] void fail_wrong_kind(const std::string& where, const std::string& key, const std::string& wanted,
                                  const Json& value);

} // namespace pliant
