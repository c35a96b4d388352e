#include "output/page/certificate_facts.h"

#include "base/common/foreign_json.h"
#include "output/page/html.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {

namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::pair<std::string, std::string>>;

constexpr std::size_t place_limit = 16, list_limit = 2000;

// The member `path` ("a/b/c"), or null.
const Json* find(const Json& json, std::string_view path)
{
    const Json* at = &json;
    while (!path.empty()) {
        const std::size_t end = std::min(path.find('/'), path.size());
        const std::string key(path.substr(0, end));
        if (!at->is_object() || !at->contains(key)) return nullptr;
        at = &at->at(key);
        path.remove_prefix(std::min(end + 1, path.size()));
    }
    return at;
}

std::optional<double> number(const Json& json, std::string_view path)
{
    const Json* value = find(json, path);
    if (!value || !value->is_number()) return {};
    const double number = value->get<double>();
    return std::isfinite(number) ? std::optional<double>(number) : std::nullopt;
}

std::optional<bool> flag(const Json& json, std::string_view path)
{
    const Json* value = find(json, path);
    return value && value->is_boolean() ? std::optional<bool>(value->get<bool>()) : std::nullopt;
}

std::string word(const Json& json, std::string_view path)
{
    const Json* value = find(json, path);
    return value && value->is_string() ? value->get<std::string>() : std::string();
}

// How weights of the asset look.
struct WeightShape {
    std::size_t pose_count;
    bool has_layers;
};

// No layer is meant to be shown so many times over.
constexpr double layer_weight_limit = 1000;

// Weights of sum 1, or of layers, or nothing.
std::vector<double> weights(const Json& json, const WeightShape& shape, std::string_view path = "weights")
{
    const Json* list = find(json, path);
    if (!list || !list->is_array() || list->size() + shape.has_layers != shape.pose_count) return {};
    std::vector<double> out;
    double sum = 0;
    for (const Json& value : *list) {
        if (!value.is_number()) return {};
        out.push_back(value.get<double>());
        if (!std::isfinite(out.back())) return {};
        if (shape.has_layers ? std::abs(out.back()) > layer_weight_limit : out.back() < 0) return {};
        sum += out.back();
    }
    if (shape.has_layers) return out;
    if (!(sum > 0) || !std::isfinite(sum)) return {};
    for (double& w : out) w /= sum;
    return out;
}

std::vector<CheckFact> checks_of(const Json& certificate, const WeightShape& shape)
{
    std::vector<CheckFact> checks;
    const Json* list = find(certificate, "measured/checks");
    if (!list || !list->is_array()) return checks;
    for (const Json& entry : *list) {
        CheckFact check;
        const std::optional<double> error = number(entry, "relative_l2");
        check.weights = weights(entry, shape);
        if (!error || *error < 0 || check.weights.empty() || checks.size() >= list_limit) continue;
        check.error = *error;
        check.distance = number(entry, "largest_distance").value_or(0);
        check.is_fresh = flag(entry, "fresh").value_or(false);
        check.has_converged = flag(entry, "converged").value_or(true);
        checks.push_back(std::move(check));
    }
    return checks;
}

std::optional<std::size_t> vertex(const Json& json, std::string_view path = "vertex")
{
    const Json* value = find(json, path);
    return value && value->is_number_unsigned() ? std::optional<std::size_t>(value->get<std::size_t>()) : std::nullopt;
}

std::size_t count(const Json& json, std::string_view path)
{
    const Json* value = find(json, path);
    return value && value->is_number_unsigned() ? value->get<std::size_t>() : 0;
}

std::vector<MixtureFact> mixtures_of(const Json& certificate)
{
    std::vector<MixtureFact> mixtures;
    const Json* list = find(certificate, "layers/errors");
    if (!list || !list->is_array()) return mixtures;
    for (const Json& entry : *list) {
        const std::string kind = word(entry, "kind");
        if (kind.empty() || mixtures.size() >= place_limit) continue;
        const auto error = [&](const char* name) { return number(entry, name).value_or(NAN); };
        mixtures.push_back({ kind, count(entry, "count"), count(entry, "without_shape"), error("mean_error"),
                             error("largest_error"), error("linear_mean_error"), error("linear_largest_error") });
    }
    return mixtures;
}

// What P4406 says of it.
std::string jump_text(const std::string& kind, const std::string& pose, bool has_layers)
{
    if (has_layers)
        return fmt::format("{} on the path towards layer {}",
                           kind == "jump" ? "The sum of layers jumps" : "There is a second sum of layers", pose);
    if (kind == "other mean") return fmt::format("There is a second average of all poses, found from pose {}", pose);
    if (kind == "turn") return fmt::format("Blends turn at once on the path towards pose {}", pose);
    return kind == "jump" ? fmt::format("The average jumps on the path towards pose {}", pose)
                          : fmt::format("There is a second average on the path to pose {}", pose);
}

std::vector<NamedPlace> places_of(const Json& certificate, const WeightShape& shape)
{
    std::vector<NamedPlace> places;
    const Json* branches = find(certificate, "branches");
    if (branches && branches->is_array())
        for (const Json& branch : *branches) {
            NamedPlace place { 4406, {}, weights(branch, shape), vertex(branch).value_or(0) };
            if (place.weights.empty() || !vertex(branch) || places.size() >= place_limit) continue;
            place.what = jump_text(word(branch, "kind"), word(branch, "pose"), shape.has_layers);
            place.what += fmt::format(": distance {}, largest at vertex {}.",
                                      percent_text(number(branch, "distance").value_or(NAN)), place.vertex);
            places.push_back(std::move(place));
        }
    const Json* drift = find(certificate, "ties/drift_of_blends");
    if (drift && vertex(*drift) && !weights(*drift, shape).empty())
        places.push_back({ 4408,
                           fmt::format("Largest drift of a part from its attachment: {} of the diagonal, at vertex {}.",
                                       percent_text(number(*drift, "largest").value_or(NAN)), *vertex(*drift)),
                           weights(*drift, shape), *vertex(*drift) });
    return places;
}

void add_number(Rows& rows, const char* name, const Json& json, std::string_view path)
{
    if (const auto value = number(json, path)) rows.push_back({ name, fmt::format("{:.6g}", *value) });
}

void add_count(Rows& rows, const char* name, const Json& json, std::string_view path)
{
    const Json* value = find(json, path);
    if (value && value->is_number_unsigned()) rows.push_back({ name, count_text(value->get<std::uint64_t>()) });
}

void add_percent(Rows& rows, const char* name, const Json& json, std::string_view path)
{
    if (const auto value = number(json, path)) rows.push_back({ name, percent_text(*value) });
}

void add_word(Rows& rows, const char* name, const Json& json, std::string_view path)
{
    const std::string value = word(json, path);
    if (!value.empty()) rows.push_back({ name, value });
}

void add_flag(Rows& rows, const char* name, const Json& json, std::string_view path)
{
    if (const auto value = flag(json, path)) rows.push_back({ name, *value ? "yes" : "no" });
}

Rows material_rows(const Json& c)
{
    Rows rows;
    add_word(rows, "Material", c, "energy/material");
    add_word(rows, "Membrane", c, "energy/membrane");
    add_number(rows, "Thickness, relative to the square root of the area", c, "energy/thickness");
    add_number(rows, "Poisson’s ratio", c, "energy/poisson");
    add_number(rows, "Bending factor of folded hinges", c, "energy/foldover_damping");
    add_count(rows, "Hinges folded over in some pose", c, "foldover_hinges");
    add_count(rows, "Rough vertices, with ARAP cells", c, "energy/rough_vertices");
    add_flag(rows, "Poses aligned", c, "energy/aligned");
    add_count(rows, "Vertices of the simulation mesh", c, "vertices");
    add_count(rows, "Tetrahedra", c, "tetrahedra");
    add_count(rows, "Welded vertices", c, "elastic/welded_vertices");
    return rows;
}

Rows subspace_rows(const Json& c)
{
    Rows rows;
    add_word(rows, "Built by", c, "subspace/kind");
    add_count(rows, "Dimension d", c, "subspace/dimension");
    add_count(rows, "Unreduced averages used to build it", c, "subspace/snapshots");
    add_count(rows, "Averages interpolated between them", c, "subspace/interpolated_averages");
    add_percent(rows, "Distance of the averages from the subspace, mean", c, "subspace/mean_error");
    add_percent(rows, "Distance of the averages from the subspace, largest", c, "subspace/largest_error");
    add_percent(rows, "Basis: largest distance from double precision, relative to the diagonal", c,
                "basis/largest_difference");
    return rows;
}

Rows surrogate_rows(const Json& c)
{
    Rows rows;
    add_word(rows, "Kind", c, "stand_in/kind");
    add_count(rows, "Elements", c, "stand_in/elements");
    add_count(rows, "Training weights", c, "stand_in/training_weights");
    add_flag(rows, "Dead load", c, "stand_in/dead_load");
    add_number(rows, "Lowest curvature at training weights", c, "stand_in/lowest_curvature");
    add_number(rows, "Highest curvature", c, "stand_in/highest_curvature");
    add_word(rows, "Why this kind", c, "stand_in/reason");
    return rows;
}

Rows measured_rows(const Json& c)
{
    Rows rows;
    add_percent(rows, "Tolerance, mean relative L2", c, "tolerance");
    add_percent(rows, "Tolerance, largest relative L2", c, "tolerance_max");
    add_percent(rows, "Error, mean", c, "measured/mean_error");
    add_percent(rows, "Error, largest", c, "measured/largest_error");
    add_percent(rows, "Largest error of a vertex, relative to the diagonal", c, "measured/largest_distance");
    add_number(rows, "Smallest triangle, relative to its smallest area in any pose", c, "measured/smallest_triangle_ratio");
    add_number(rows, "Smallest volume ratio of a tetrahedron", c, "measured/smallest_j");
    add_percent(rows, "Runtime against double precision", c, "measured/runtime_against_double");
    add_count(rows, "Checks whose reference did not converge", c, "measured/unconverged_checks");
    return rows;
}

Rows bake_rows(const Json& c)
{
    Rows rows;
    add_word(rows, "Baked by", c, "baker");
    add_word(rows, "Factorisation", c, "energy/solver");
    add_count(rows, "Factorisations", c, "factorizations");
    add_count(rows, "Seed", c, "seed");
    return rows;
}

} // namespace

CertificateFacts read_certificate_facts(const std::string& text, std::size_t pose_count, bool has_layers)
{
    const WeightShape shape { pose_count, has_layers };
    CertificateFacts facts;
    const Json c = parse_foreign_json(text);
    if (!c.is_object()) return facts;
    facts.is_readable = true;
    facts.tolerance = number(c, "tolerance").value_or(0);
    facts.tolerance_max = number(c, "tolerance_max").value_or(0);
    facts.meets_tolerance = flag(c, "meets_tolerance");
    facts.checks = checks_of(c, shape);
    if (has_layers) facts.mixtures = mixtures_of(c);
    facts.worst_weights = weights(c, shape, "measured/worst_weights");
    if (!facts.checks.empty()) { // without checks its zeros mean nothing
        facts.mean_error = number(c, "measured/mean_error");
        facts.largest_error = number(c, "measured/largest_error");
        facts.largest_distance = number(c, "measured/largest_distance");
    }
    facts.largest_drift = number(c, "ties/drift_of_blends/largest");
    facts.places = places_of(c, shape);
    facts.roughest_vertex = vertex(c, "energy/roughest_vertex");
    facts.groups = { { "Elastic material", material_rows(c) },
                     { "Reduced space", subspace_rows(c) },
                     { "Surrogate energy", surrogate_rows(c) },
                     { "Measured", measured_rows(c) },
                     { "The bake", bake_rows(c) } };
    // Ours are short. Indentation can make a long one thirty times as long.
    constexpr std::size_t longest = 200000;
    facts.pretty = c.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (facts.pretty.size() < longest) facts.pretty = c.dump(2, ' ', false, Json::error_handler_t::replace);
    return facts;
}

} // namespace pliant
