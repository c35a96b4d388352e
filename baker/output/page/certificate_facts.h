// What a page tells of a certificate: read with care, since a file of a stranger may hold anything in its place.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pliant {

struct CheckFact {
    std::vector<double> weights; // as many as poses, of sum 1; or as many as layers
    double error = 0;            // relative L2
    double distance = 0;         // of the farthest vertex, over the diagonal
    bool is_fresh = false, has_converged = true;
};

// Blends of one kind of mixture of layers: relative L2 of the blend, and of the linear sum.
struct MixtureFact {
    std::string kind;
    std::size_t count = 0, lost_count = 0; // with errors; where no shape was found to compare with
    double mean = 0, largest = 0, linear_mean = 0, linear_largest = 0;
};

// A place that a warning of the bake named: P4406 (branches) and P4408 (parts that drift).
struct NamedPlace {
    int number = 0;
    std::string what;
    std::vector<double> weights;
    std::size_t vertex = 0; // as the pose files count
};

struct CertificateFacts {
    bool is_readable = false;
    double tolerance = 0, tolerance_max = 0; // of the mean error; of the largest one, 0: no limit
    std::optional<bool> meets_tolerance;
    std::optional<double> mean_error, largest_error, largest_distance;
    std::optional<double> largest_drift; // of a part from its attachment, over the diagonal
    std::vector<CheckFact> checks;       // in the order of the file, those that make sense
    std::vector<MixtureFact> mixtures;   // of layers
    std::vector<double> worst_weights;   // of the largest error; empty: unknown
    std::vector<NamedPlace> places;
    std::optional<std::size_t> roughest_vertex; // as the pose files count
    std::vector<std::pair<std::string, std::vector<std::pair<std::string, std::string>>>>
        groups;         // title; name and value: plain text
    std::string pretty; // the JSON, indented
};

// `has_layers`: the poses are a rest shape and layers on it, so there is a weight less than poses.
CertificateFacts read_certificate_facts(const std::string& text, std::size_t pose_count, bool has_layers = false);

} // namespace pliant
