// The stamp beside an asset says what it was baked from, so that the same work is not done twice.
#pragma once

#include "input/io/read_log.h"
#include "pipeline/json_file.h"

#include <string>
#include <vector>

namespace pliant {

// The stamp of an output: OUTPUT.stamp.
std::string stamp_path(const std::string& output);

// The options of a bake that its bytes depend on, from its effective configuration: no times of day, thread counts or names
// of outputs. Paths as seen from the folder of the output, so that a tree may be moved as a whole.
Json stamped_options(const Json& configuration, const std::string& output);

// What is written: JSON with "stamp" (its version), "baker", "options", "inputs" (path from the folder of the output and
// SHA-256; null where there was no such file), "output" (SHA-256), "exit_code" and "seconds". No absolute path unless there
// is no other.
struct StampContent {
    Json options;                // of stamped_options
    std::vector<ReadFile> files; // that were read
    std::string output;          // path
    std::string output_digest;
    int exit_code = 0; // 0, or 4: written although it misses the tolerance
    double seconds = 0;
};
std::string write_stamp(const StampContent& content);

// Why an output is not up to date, in a few words; empty if it is: its stamp is of this baker and these options, and all
// inputs and the output itself hold the bytes that the stamp names. Times of files do not count. Reads all of them.
struct StampVerdict {
    std::string reason;
    int exit_code = 0; // of the bake that the stamp tells of, if it is up to date
};
StampVerdict check_stamp(const Json& options, const std::string& output);

} // namespace pliant
