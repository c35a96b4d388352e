// What a page tells of a certificate: read with care, since a file of a stranger may hold anything in its place.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pliant {

struct CheckFact {
    std::vector<double> weights; // as many as poses, of sum 1
    double error = 0;            // relative L2
    double distance = 0;         // of the farthest vertex, over the diagonal
    bool is_fresh = false, has_converged = true;
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
    double tolerance = 0;
    std::optional<bool> meets_tolerance;
    std::optional<double> mean_error, largest_error, largest_distance;
    std::vector<CheckFact> checks; // in the order of the file, those that make sense
    std::vector<NamedPlace> places;
    std::optional<std::size_t> roughest_vertex; // as the pose files count
    std::vector<std::pair<std::string, std::vector<std::pair<std::string, std::string>>>>
        groups;         // title; name and value: plain text
    std::string pretty; // the JSON, indented
};

CertificateFacts read_certificate_facts(const std::string& text, std::size_t pose_count);

} // namespace pliant
