// The errors of a kind of mixture of layers as a line of text: `pliant bake` and `pliant info` print it.
#pragma once

#include "bake/report.h"

#include <string>

namespace pliant {

// "pair: 9 mixtures, relative L2 1.2e-03 (mean), 2.4e-03 (largest); linear sum 4.1e-02 and 9.9e-02"
std::string kind_line(const KindErrors& kind);

} // namespace pliant
