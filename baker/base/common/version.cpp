#include "base/common/version.h"

namespace pliant {

const char* const version = PLIANT_VERSION;
const char* const baker_version = "pliant " PLIANT_VERSION;

} // namespace pliant
