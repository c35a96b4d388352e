// The memory that a process may use.
#pragma once

namespace pliant {

// Bytes: of the machine, of the container (control groups, version 2 and 1) or of the process (ulimit -v), whichever has
// least.
double available_memory();

} // namespace pliant
