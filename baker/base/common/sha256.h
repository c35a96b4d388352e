// SHA-256 (FIPS 180-4): what says that two files hold the same bytes.
#pragma once

#include <string>
#include <string_view>

namespace pliant {

// The digest as 64 hexadecimal digits, as sha256sum and Python's hashlib print it. Some 200 MB a second.
std::string sha256_hex(std::string_view bytes);

} // namespace pliant
