// The version, as CMakeLists.txt reads it from runtime/pliant.h.
#pragma once

namespace pliant {

extern const char* const version; // "0.1.0", say

// What made an asset: in its certificate, in stamps and in GLB files. "pliant 0.1.0", say.
extern const char* const baker_version;

} // namespace pliant
