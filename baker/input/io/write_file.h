// The one way in which Pliant writes files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant {

// Replaces or creates the file, whole or not at all: the bytes go to .NAME.pliant-tmp-PID in the same folder, are flushed to
// the disk, and only then take the name. Whatever happens before (full disk, exception, kill -9) leaves the old file as it
// was; a temporary of the same NAME whose process is dead is removed. Permissions of an existing file are kept; a symbolic
// link is followed. Two writers of one name: one of the two whole files stays.
// Throws Failure (failed), P40xx.
void write_file_atomically(const std::string& path, std::string_view bytes);

// To be called before long work: finds out what would make write_file_atomically fail (no such folder, not writable, a
// folder or a device in the way) or overwrite one of `inputs`. Leaves nothing behind. Throws Failure (failed), P40xx.
void probe_output(const std::string& path, const std::vector<std::string>& inputs);

} // namespace pliant
