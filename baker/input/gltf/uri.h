// What a glTF file may name: bytes in the text itself, and files beside it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pliant {

bool is_data_uri(std::string_view uri);

// The bytes of "data:...;base64,...". Nothing if it is of another kind or damaged.
std::optional<std::string> decode_data_uri(std::string_view uri);

// A relative name of a file below the folder, percent-decoded. Nothing for absolute names, other schemes (http:, file:),
// "..", more than 4096 bytes, and whatever has control characters or a backslash.
std::optional<std::string> decode_file_uri(std::string_view uri);

} // namespace pliant
