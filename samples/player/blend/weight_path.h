// Lists of blend weights in text files, as `pliant blend --path` reads them, and names of numbered files. No graphics in here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pliant::player {

// Blend weights, a line a frame. Each row has one weight per pose, >= 0, sum 1.
class WeightPath {
public:
    // Reads the file: numbers separated by commas; empty lines and lines that start with # count for nothing. Throws Error
    // (P5913) naming the line that is not pose_count weights, or if no line is.
    WeightPath(const std::string& file, std::uint32_t pose_count);
    // rows: at least one, each as above.
    explicit WeightPath(std::vector<std::vector<double>> rows);

    std::size_t count() const { return rows_.size(); }
    const std::vector<double>& row(std::size_t i) const { return rows_[i]; }
    const std::vector<std::vector<double>>& rows() const { return rows_; }

    // Between rows the weights are mixed. The path is a loop: the last row is followed by the first. frame: any number.
    std::vector<double> at(double frame) const;

private:
    std::vector<std::vector<double>> rows_;
};

// "frame_%04d.png" with the number in place of its one integer conversion, the rule of `pliant blend`. Throws Error (P5941)
// under the name of the option if the pattern does not say where the number goes.
std::string numbered_name(const std::string& option, const std::string& pattern, std::size_t number);

// Numbers with a separator between them, locale or not, blanks around them allowed. Empty if the text is anything else.
std::vector<double> parse_numbers(const std::string& text, char separator);

// Divides by the sum. False, and nothing is changed, if the weights are not finite numbers >= 0 with a positive sum.
bool normalise_weights(std::vector<double>& weights);

} // namespace pliant::player
