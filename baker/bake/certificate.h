// The certificate: JSON inside every asset that says how it was baked and what was measured (chunk CERT).
#pragma once

#include "bake/options.h"
#include "bake/report.h"
#include "base/common/diagnostics.h"

#include <optional>

#include <string>

namespace pliant {

// No times, no paths: the same input and options give the same text.
std::string write_certificate(const BakeReport& report, const BakeOptions& options,
                              const std::vector<std::string>& pose_names);

// Reads back the options that define the energy, so that a measurement uses the one that was baked. Throws Failure
// (bad_input, P5103) naming `path` if the text is not a certificate of ours, or not of an asset that has layers or has none.
EnergyOptions read_energy_options(const std::string& certificate, bool has_layers, const std::string& path);

// The pose from which the average of all poses is reached, so that a measurement takes the same branch; empty if it does not
// say. Throws Failure (bad_input, P5103) naming `path` if there is no such pose.
std::optional<std::size_t> read_start_pose(const std::string& certificate, std::size_t pose_count, const std::string& path);

// How far the stored basis may move a vertex, as a fraction of the diagonal; 0 if the certificate does not say.
double read_position_error(const std::string& certificate);

// The report for people and build systems (`--report`): the certificate plus times, the name of the asset (relative to the
// report's folder) and the warnings with the elements that they are about.
std::string write_report(const BakeReport& report, const std::string& asset = {},
                         const std::vector<Diagnostic>& warnings = {});

} // namespace pliant
