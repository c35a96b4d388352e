// The memory that a process may use.
#pragma once

#include <cstddef>

namespace pliant {

// Bytes: of the machine, of the container (control groups, version 2 and 1) or of the process (ulimit -v, ulimit -d),
// whichever has least.
double available_memory();

// Whether memory can be refused while the machine has some: by ulimit -v, ulimit -d, or a system that never overcommits.
bool is_memory_limited();

// Whether that much address space can be had now.
bool has_room(std::size_t size);

} // namespace pliant
