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
std::set<double> telling_values(const Primitives& primitives)
{
    constexpr std::size_t enough = 16;
    std::set<double> values;
    for (const GltfPrimitive* primitive : primitives)
        for (Eigen::Index i = 0; i < primitive->positions.size() && values.size() < enough; ++i) {
            const double value = std::abs(primitive->positions.data()[i]);
            if (value > 0 && value < 1) values.insert(value);
        }
    return values;
}

// The fewest divisions that have all values, rounded to `bits`, where there are few. The vertices of a regular grid have the
// pattern of 8 bits if it has 3, 5, 15 or 17 divisions.
double divisions_of(const std::set<double>& values, int bits)
{
    constexpr double most_divisions = 1024;
    const double units = std::exp2(bits) - 1;
    double divisions = 1;
    const auto is_on_it
        = [&](double value) { return std::abs(value - std::round(value * divisions) / divisions) * units <= 0.5 + 1e-6; };
    while (divisions <= most_divisions && !std::all_of(values.begin(), values.end(), is_on_it)) ++divisions;
    return divisions <= most_divisions ? divisions : INFINITY;
}

bool set_steps(const Primitives& primitives, int bits)
{
    const std::set<double> values = telling_values(primitives);
    for (int fewer = fewest_bits; fewer < bits && (bits - fewer) * int(values.size()) >= sure_bits; ++fewer) {
        if (!are_widened(primitives, bits, fewer)) continue;
        const double unit_count = std::exp2(fewer) - 1;
        if (divisions_of(values, bits) < unit_count) return false; // a coarser grid in all bits explains them, too
        for (GltfPrimitive* primitive : primitives) primitive->position_step = 1 / unit_count;
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
