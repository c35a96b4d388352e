// Lists of blend weights in text files, as `pliant blend --path` reads them, and numbered file names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pliant::player {

// Blend weights, one row per frame. Each row has one weight per pose, >= 0, sum 1, or one weight per layer.
class WeightPath {
public:
    // Reads the file: numbers separated by commas; empty lines and lines that start with # are ignored. Throws Error
    // (P5913) with the number of the first line that does not hold weight_count weights, or if the file holds no weights.
    WeightPath(const std::string& file, std::uint32_t weight_count, bool of_layers = false);
    // rows: at least one, each as above.
    explicit WeightPath(std::vector<std::vector<double>> rows);

    std::size_t count() const { return rows_.size(); }
    const std::vector<double>& row(std::size_t i) const { return rows_[i]; }
    const std::vector<std::vector<double>>& rows() const { return rows_; }

    // Weights at any frame number, interpolated between rows. The path is a loop: the first row follows the last.
    std::vector<double> at(double frame) const;

private:
    std::vector<std::vector<double>> rows_;
};

// Puts the number into a pattern such as "frame_%04d.png", which must have exactly one integer conversion, as for `pliant
// blend`. Throws Error (P5941), which names the option, for any other pattern.
std::string numbered_name(const std::string& option, const std::string& pattern, std::size_t number);

// Parses numbers with a separator between them, independent of the locale; blanks are allowed. Empty for any other text.
std::vector<double> parse_numbers(const std::string& text, char separator);

// Divides by the sum. Returns false and changes nothing unless all weights are finite, >= 0, and at least one is positive.
bool normalise_weights(std::vector<double>& weights);

// Gives one of several shares, whose sum is 1, a new value from 0 to 1. The others make room in their proportions; if they
// are all zero, in equal parts.
void set_share(std::vector<double>& shares, std::size_t which, double value);

// Whether all weights are finite in single precision, as those of layers must be.
bool are_finite(const std::vector<double>& weights);

// "2 weights for 3 poses"
std::string count_of_weights(std::size_t given, std::uint32_t weight_count, bool of_layers);

} // namespace pliant::player
