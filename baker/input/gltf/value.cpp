#include "input/gltf/value.h"

#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace pliant {

namespace {

std::string key_in_place(const std::string& key)
{
    constexpr std::size_t longest = 64; // a stranger's key would fill the screen
    return "." + key.substr(0, longest);
}

} // namespace

std::string GltfValue::place() const
{
    std::string place;
    for (std::size_t i = 0; i < step_count_; ++i) {
        if (is_cut_ && i + 1 == longest_way) place += "...";
        place += way_[i].key ? key_in_place(*way_[i].key) : fmt::format("[{}]", way_[i].index);
    }
    place += missing_;
    return place.empty() || place[0] != '.' ? place : place.substr(1);
}

GltfValue GltfValue::step(const GltfJson& to, Step step) const
{
    GltfValue out = *this;
    out.json_ = &to;
    out.is_cut_ = step_count_ == longest_way;
    if (!out.is_cut_) ++out.step_count_;
    out.way_[out.step_count_ - 1] = step;
    return out;
}

GltfValue GltfValue::absent(const std::string& step) const
{
    GltfValue out = *this;
    out.missing_ += step;
    return out;
}

void GltfValue::fail(int number, const std::string& what, const std::string& hint) const
{
    const std::string where = place();
    Diagnostic diagnostic { Diagnostic::Severity::error, number, *file_, where.empty() ? what : where + ": " + what,
                            hint.empty() ? "the file is damaged: export it again; a glTF validator says more" : hint };
    throw Failure(ExitCode::bad_input, std::move(diagnostic));
}

void GltfValue::expect(const char* what) const
{
    const std::string expected = fmt::format("{} expected", what);
    Diagnostic diagnostic
        = error_at(2306, *file_, fmt::format("{}: {}{}", place(), exists() ? "" : "is missing: ", expected),
                   "the file is damaged: export it again; a glTF validator says more");
    throw Failure(ExitCode::bad_input, std::move(diagnostic));
}

GltfValue GltfValue::operator[](const std::string& key) const
{
    if (exists() && !json_->is_object()) expect("an object");
    const auto member = exists() ? json_->find(key) : json_->end();
    if (member == json_->end()) return absent(key_in_place(key));
    return step(*member, { &member.key(), 0 });
}

std::size_t GltfValue::size() const
{
    if (!exists()) return 0;
    if (!json_->is_array()) expect("a list");
    return json_->size();
}

GltfValue GltfValue::at(std::size_t i) const
{
    if (i >= size()) return absent(fmt::format("[{}]", i));
    return step((*json_)[i], { nullptr, i });
}

std::uint64_t GltfValue::whole() const
{
    constexpr double limit = 9007199254740992.0; // 2^53: whole numbers are exact up to here, however they are written
    if (!exists() || !json_->is_number()) expect("a whole number");
    const double value = json_->get<double>();
    if (!(value >= 0 && value <= limit) || value != std::floor(value)) expect("a whole number of at least 0");
    return static_cast<std::uint64_t>(value);
}

std::size_t GltfValue::index(std::size_t count, const char* things) const
{
    const std::uint64_t value = whole();
    if (value >= count) {
        Diagnostic diagnostic
            = error_at(2307, *file_, fmt::format("{} is {}, the file has {} {}", place(), value, count, things),
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
    if (!exists() || !json_->is_number()) expect("a number");
    const double value = json_->get<double>();
    if (!std::isfinite(value)) expect("a finite number");
    return value;
}

std::vector<double> GltfValue::numbers(std::size_t count) const
{
    if (!exists() || !json_->is_array() || json_->size() != count)
        expect(fmt::format("a list of {} numbers", count).c_str());
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(at(i).number());
    return values;
}

std::string GltfValue::text() const
{
    if (!exists() || !json_->is_string()) expect("a string");
    return json_->get<std::string>();
}

bool GltfValue::reference_or(bool missing) const
{
    if (!exists()) return missing;
    if (!json_->is_boolean()) expect("true or false");
    return json_->get<bool>();
}

} // namespace pliant
