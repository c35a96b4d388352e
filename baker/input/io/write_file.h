// The one way in which Pliant writes files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant {

// Replaces or creates the file, whole or not at all: the bytes go to .NAME.pliant-tmp-RANDOM in the same folder, are flushed
// to the disk, and only then take the name. Whatever happens before (full disk, exception, kill -9) leaves the old file as
// it was. Writers of other processes, containers and machines may write the same name: one of the whole files stays. A
// temporary of the same NAME that nobody has locked is removed (without locks: one of yesterday). Permissions of an existing
// file are kept, also those that forbid to write it: the folder's count. A symbolic link is followed. Throws Failure
// (failed), P40xx.
void write_file_atomically(const std::string& path, std::string_view bytes);

// To be called before long work: finds out what would make write_file_atomically fail (no such folder, not writable, a
// folder or a device in the way), overwrite one of `inputs`, or write two of `paths` to one file. Empty paths are left out.
// Leaves nothing behind. Throws Failure (failed), P40xx.
void probe_outputs(const std::vector<std::string>& paths, const std::vector<std::string>& inputs);

} // namespace pliant
