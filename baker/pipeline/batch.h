// Many bakes in child processes: what is to be done, in which order, and what came of it.
#pragma once

#include "pipeline/json_file.h"

#include <string>
#include <vector>

namespace pliant {

enum class Outcome {
    pending,          // to be baked
    up_to_date,       // nothing to do
    baked,            // done now
    misses_tolerance, // exit code 4, now or, where the asset was written all the same, when it was baked
    failed,           // another exit code
    crashed,          // killed by a signal
    too_large,        // more memory than there is for all
    not_started,      // after a failure with --fail-fast, or an interrupt
    interrupted
};

// One bake of a manifest.
struct BatchJob {
    std::string name, output;
    std::vector<std::string> arguments; // of the tool, behind "bake"
    Json options;                       // of its stamp
    std::vector<std::string> extras;    // further outputs, which must be there
    std::vector<std::string> inputs;    // files that the manifest names

    std::string reason;   // why it is not up to date
    std::string error;    // the first that its process has named: "poses/run.ply:812: face 377 uses ..."
    int error_number = 0; // 2103; 0: none
    Outcome outcome = Outcome::pending;
    int exit_code = 0, signal = 0;
    double seconds = 0, peak_memory = 0;                       // of the child
    double estimated_seconds = 0, estimated_memory = 0;        // seconds, bytes
    long estimated_dimension = 0, dimension = 0, elements = 0; // 0: not known
    double mean_error = 0, largest_error = 0, file_size = 0;   // of the asset
    bool has_error = false;                                    // the two errors were measured
};

struct BatchOptions {
    std::size_t job_count = 1;
    double memory = 0; // bytes for all bakes that run together
    bool is_fail_fast = false, is_quiet = false, is_verbose = false;
    int wake = -1; // readable once the user wants to stop
};

// Finds out which assets are up to date, with the bytes of every input read. Sets outcome and reason.
void judge_stamps(std::vector<BatchJob>& jobs, bool is_forced);

// Of every bake that is to be done the poses are checked and the cost is estimated, in child processes. Sets outcome and
// estimates. Messages and progress go to standard error. False if the user has stopped it.
bool plan_batch(std::vector<BatchJob>& jobs, const BatchOptions& options);

// Does what is pending: at most job_count at a time, whose estimates together stay within the memory; of those that fit, the
// first in the list starts first. Sets outcomes and what was measured. False if the user has stopped it: children have ended
// then.
bool run_batch(std::vector<BatchJob>& jobs, const BatchOptions& options);

// What of an asset belongs into the summary: size, dimension, elements and errors of its certificate.
void read_figures(BatchJob& job);

// 0: all is done; 130: interrupted; 4: some miss their tolerance, and nothing else is wrong; else 1.
int exit_code_of(const std::vector<BatchJob>& jobs);

// For people: one line a bake.
std::string plan_table(const std::vector<BatchJob>& jobs);
std::string summary_table(const std::vector<BatchJob>& jobs);

// For programs: bake_all_report.schema.json.
Json summary_json(const std::vector<BatchJob>& jobs, double seconds, int exit_code);

// "up to date", "misses tolerance", ...
std::string name_of(Outcome outcome);

// "1.4 MiB", "16.0 GiB".
std::string size_text(double bytes);

} // namespace pliant
