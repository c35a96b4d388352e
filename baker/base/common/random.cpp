#include "base/common/random.h"

#include <cmath>

namespace pliant {

double Random::normal()
{
    // Box-Muller; 1 - u keeps the logarithm finite.
    return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(6.283185307179586 * uniform());
}

} // namespace pliant
