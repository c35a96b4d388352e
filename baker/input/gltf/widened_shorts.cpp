#include "input/gltf/widened_shorts.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace pliant {
namespace {

constexpr int fewest_bits = 8, sure_bits = 8; // a pattern that chance makes with a probability of 2^-8

using Primitives = std::vector<GltfPrimitive*>;

// `bits` wide: the highest `fewer` of them, and below these the highest again.
bool is_widened(std::uint32_t number, int bits, int fewer)
{
    const std::uint32_t kept = number >> (bits - fewer);
    return (kept << (bits - fewer) | kept >> (2 * fewer - bits)) == number;
}

bool are_widened(const Primitives& primitives, int bits, int fewer)
{
    const double units = std::exp2(bits) - 1;
    const auto is_one = [&](double p) { return is_widened(std::uint32_t(std::abs(p) * units + 0.5), bits, fewer); };
    return std::all_of(primitives.begin(), primitives.end(), [&](const GltfPrimitive* primitive) {
        const GltfNumbers& p = primitive->positions;
        return std::all_of(p.data(), p.data() + p.size(), is_one);
    });
}

// Different numbers but 0 and the largest, which have the pattern of any number of bits; no more than are asked for.
int count_telling(const Primitives& primitives)
{
    std::set<double> values;
    for (const GltfPrimitive* primitive : primitives)
        for (Eigen::Index i = 0; i < primitive->positions.size() && values.size() < sure_bits; ++i) {
            const double value = std::abs(primitive->positions.data()[i]);
            if (value > 0 && value < 1) values.insert(value);
        }
    return static_cast<int>(values.size());
}

bool set_steps(const Primitives& primitives, int bits)
{
    const int telling = count_telling(primitives);
    for (int fewer = fewest_bits; fewer < bits && (bits - fewer) * telling >= sure_bits; ++fewer) {
        if (!are_widened(primitives, bits, fewer)) continue;
        for (GltfPrimitive* primitive : primitives) primitive->position_step = 1 / (std::exp2(fewer) - 1);
        return true;
    }
    return false;
}

} // namespace

void find_widened_shorts(const Primitives& primitives)
{
    for (const int bits : { 15, 16 }) {
        Primitives alike;
        for (GltfPrimitive* primitive : primitives)
            if (primitive->short_bits == bits) alike.push_back(primitive);
        if (set_steps(alike, bits)) continue;
        for (GltfPrimitive* primitive : alike) set_steps({ primitive }, bits);
    }
}

} // namespace pliant
