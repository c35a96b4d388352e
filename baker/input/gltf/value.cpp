#include "input/gltf/value.h"

#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace pliant {

void GltfValue::fail(int number, const std::string& what, const std::string& hint) const
{
    Diagnostic diagnostic { Diagnostic::Severity::error, number, *file_, place_.empty() ? what : place_ + ": " + what,
                            hint.empty() ? "the file is damaged: export it again; a glTF validator says more" : hint };
    throw Failure(ExitCode::bad_input, std::move(diagnostic));
}

void GltfValue::expect(const char* what) const
{
    const std::string expected = fmt::format("{} expected", what);
    Diagnostic diagnostic = error_at(2306, *file_, fmt::format("{}: {}{}", place_, exists() ? "" : "is missing: ", expected),
                                     "the file is damaged: export it again; a glTF validator says more");
    throw Failure(ExitCode::bad_input, std::move(diagnostic));
}

GltfValue GltfValue::operator[](const std::string& key) const
{
    constexpr std::size_t longest = 64; // a stranger's key would be copied into the place of each member below it
    const std::string name = key.substr(0, longest), place = place_.empty() ? name : place_ + "." + name;
    if (!json_) return { *file_, nullptr, place };
    if (!json_->is_object()) expect("an object");
    const auto member = json_->find(key);
    return { *file_, member == json_->end() ? nullptr : &*member, place };
}

std::size_t GltfValue::size() const
{
    if (!json_) return 0;
    if (!json_->is_array()) expect("a list");
    return json_->size();
}

GltfValue GltfValue::at(std::size_t i) const
{
    const std::string place = fmt::format("{}[{}]", place_, i);
    return { *file_, i < size() ? &(*json_)[i] : nullptr, place };
}

std::uint64_t GltfValue::whole() const
{
    constexpr double limit = 9007199254740992.0; // 2^53: whole numbers are exact up to here, however they are written
    if (!json_ || !json_->is_number()) expect("a whole number");
    const double value = json_->get<double>();
    if (!(value >= 0 && value <= limit) || value != std::floor(value)) expect("a whole number of at least 0");
    return static_cast<std::uint64_t>(value);
}

std::size_t GltfValue::index(std::size_t count, const char* things) const
{
    const std::uint64_t value = whole();
    if (value >= count) {
        Diagnostic diagnostic
            = error_at(2307, *file_, fmt::format("{} is {}, the file has {} {}", place_, value, count, things),
                       "the file is damaged: export it again; a glTF validator says more");
        throw Failure(ExitCode::bad_input, std::move(diagnostic));
    }
    return static_cast<std::size_t>(value);
}

std::ptrdiff_t GltfValue::index_or_none(std::size_t count, const char* things) const
{
    return exists() ? static_cast<std::ptrdiff_t>(index(count, things)) : -1;
}

double GltfValue::number() const
{
    if (!json_ || !json_->is_number()) expect("a number");
    const double value = json_->get<double>();
    if (!std::isfinite(value)) expect("a finite number");
    return value;
}

std::vector<double> GltfValue::numbers(std::size_t count) const
{
    if (!json_ || !json_->is_array() || json_->size() != count) expect(fmt::format("a list of {} numbers", count).c_str());
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(at(i).number());
    return values;
}

std::string GltfValue::text() const
{
    if (!json_ || !json_->is_string()) expect("a string");
    return json_->get<std::string>();
}

bool GltfValue::reference_or(bool missing) const
{
    if (!json_) return missing;
    if (!json_->is_boolean()) expect("true or false");
    return json_->get<bool>();
}

} // namespace pliant
