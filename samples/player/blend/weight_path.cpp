#include "blend/weight_path.h"

#include "blend/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace pliant::player {
namespace {

[[noreturn]] void refuse_path(const std::string& where, const std::string& reason)
{
    throw Error(ErrorNumber::path_refused, ExitCode::bad_input, where + ": " + reason,
                "write one line per frame, one weight per pose or layer, separated by commas; # starts a comment");
}

} // namespace

std::vector<double> parse_numbers(const std::string& text, char separator)
{
    std::vector<double> numbers;
    const char* at = text.data();
    const char* end = at + text.size();
    const auto skip_blanks = [&] {
        while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    };
    while (true) {
        double value = 0.0;
        skip_blanks();
        const auto [stop, error] = std::from_chars(at, end, value);
        if (error != std::errc() || !std::isfinite(value)) return {};
        numbers.push_back(value);
        at = stop;
        skip_blanks();
        if (at == end) return numbers;
        if (*at != separator) return {};
        ++at;
    }
}

bool normalise_weights(std::vector<double>& weights)
{
    double largest = 0.0;
    for (double weight : weights) {
        if (!std::isfinite(weight) || weight < 0.0) return false;
        largest = std::max(largest, weight);
    }
    if (!(largest > 0.0)) return false;
    double sum = 0.0;
    for (double& weight : weights) sum += weight /= largest; // scaled first: the sum of very large weights must not overflow
    for (double& weight : weights) weight /= sum;
    return true;
}

void set_share(std::vector<double>& shares, std::size_t which, double value)
{
    value = std::clamp(value, 0.0, 1.0);
    double others = 0.0;
    for (std::size_t k = 0; k < shares.size(); ++k) others += k == which ? 0.0 : shares[k];
    const auto count = static_cast<double>(shares.size() - 1);
    for (double& share : shares) share = others > 1e-9 ? share * (1.0 - value) / others : (1.0 - value) / count;
    shares[which] = value;
}

bool are_finite(const std::vector<double>& weights)
{
    return std::all_of(weights.begin(), weights.end(),
                       [](double weight) { return std::isfinite(static_cast<float>(weight)); });
}

std::string count_of_weights(std::size_t given, std::uint32_t weight_count, bool of_layers)
{
    return std::to_string(given) + " weights for " + std::to_string(weight_count) + (of_layers ? " layers" : " poses");
}

WeightPath::WeightPath(const std::string& file, std::uint32_t weight_count, bool of_layers)
{
    std::error_code error;
    if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
        refuse_path(file, "is a folder or a device, not a list of weights");
    std::ifstream stream(file);
    std::string line;
    for (std::size_t number = 1; std::getline(stream, line); ++number) {
        if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
        std::vector<double> weights = parse_numbers(line, ',');
        const std::string where = file + ":" + std::to_string(number);
        if (weights.empty()) refuse_path(where, "'" + line.substr(0, 60) + "' is not a list of numbers");
        if (weights.size() != weight_count) refuse_path(where, count_of_weights(weights.size(), weight_count, of_layers));
        if (of_layers && !are_finite(weights)) refuse_path(where, "a weight is not finite in single precision");
        if (!of_layers && !normalise_weights(weights))
            refuse_path(where, "the weights are not all >= 0 with a positive sum");
        rows_.push_back(std::move(weights));
    }
    if (!stream.is_open() || stream.bad() || (stream.fail() && !stream.eof())) refuse_path(file, "cannot be read");
    if (rows_.empty()) refuse_path(file, "holds no weights");
}

WeightPath::WeightPath(std::vector<std::vector<double>> rows)
    : rows_(std::move(rows))
{
}

std::vector<double> WeightPath::at(double frame) const
{
    const auto count = static_cast<double>(rows_.size());
    const double in_loop = frame - std::floor(frame / count) * count;
    const double whole = std::floor(in_loop), share = in_loop - whole;
    const std::size_t first = static_cast<std::size_t>(whole) % rows_.size(); // rounding can give `count` itself
    const std::vector<double>&from = rows_[first], &to = rows_[(first + 1) % rows_.size()];
    std::vector<double> weights(from.size());
    for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = (1.0 - share) * from[k] + share * to[k];
    return weights;
}

std::string numbered_name(const std::string& option, const std::string& pattern, std::size_t number)
{
    const std::size_t percent = pattern.find('%');
    const std::size_t end = percent == std::string::npos ? percent : pattern.find_first_not_of("0123456789", percent + 1);
    if (end == std::string::npos || pattern[end] != 'd' || pattern.find('%', end) != std::string::npos) {
        throw Error(ErrorNumber::no_frame_number, ExitCode::usage,
                    option + ": '" + pattern + "' has no place for the frame number",
                    "write it as frame_%04d, with one %d or %04d");
    }
    const std::string digits = pattern.substr(percent + 1, end - percent - 1);
    const std::size_t width = digits.empty() ? 0 : std::min<std::size_t>(std::stoul(digits.substr(0, 4)), 20);
    std::string text = std::to_string(number);
    if (text.size() < width) text.insert(0, width - text.size(), digits[0] == '0' ? '0' : ' ');
    return pattern.substr(0, percent) + text + pattern.substr(end + 1);
}

} // namespace pliant::player
