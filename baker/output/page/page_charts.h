// The drawings of a page: inline SVG, and tables with bars. All return HTML.
#pragma once

#include "output/page/certificate_facts.h"
#include "output/page/page_data.h"

#include <string>
#include <vector>

namespace pliant {

// Colour of pose k in legends and strips, as a CSS variable.
std::string pose_colour(std::size_t pose);

// "42 % run, 30 % jump, 28 % rest": the largest first, below 1 % left out. Of layers "smile 1, blink −0.5".
std::string weights_in_words(const std::vector<double>& weights, const std::vector<std::string>& poses);

// Errors over the weights: for two poses a curve, for three a triangle, for more one bar a check with the weights beside it.
// Of layers none of these: the table of the worst weights alone.
std::string error_chart(const CertificateFacts& facts, const std::vector<std::string>& poses);

// Amplitude and bits of each column of the basis.
std::string spectrum_chart(const std::vector<PageColumn>& columns);

// Rows of name, explanation, bar and numbers.
struct BarRow {
    std::string name, explanation, value; // plain text
    double part = 0;                      // of the whole
};
std::string bar_table(const std::vector<BarRow>& rows, const char* name_title, const char* value_title);

} // namespace pliant
