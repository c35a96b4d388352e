#include "base/common/random.h"

#include <cmath>
#include <numeric>
#include <utility>

namespace pliant {

double Random::normal()
{
    // Box-Muller; 1 - u keeps the logarithm finite.
    return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(6.283185307179586 * uniform());
}

std::vector<std::size_t> Random::distinct(std::size_t count, std::size_t wanted)
{
    std::vector<std::size_t> all(count);
    std::iota(all.begin(), all.end(), std::size_t(0));
    for (std::size_t i = 0; i < wanted; ++i) std::swap(all[i], all[i + below(count - i)]);
    all.resize(wanted);
    return all;
}

} // namespace pliant
