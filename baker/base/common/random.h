// Random numbers that are the same on every platform.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace pliant {

// The standard fixes the generator, but not its distributions: those are our own.
class Random {
public:
    explicit Random(std::uint64_t seed)
        : engine_(seed)
    {
    }
    double uniform() { return double(engine_() >> 11) * 0x1p-53; } // [0, 1)
    double normal();
    std::size_t below(std::size_t count) { return std::size_t(uniform() * double(count)); }
    // `wanted` different numbers below `count` (not more than there are), in random order.
    std::vector<std::size_t> distinct(std::size_t count, std::size_t wanted);

private:
    std::mt19937_64 engine_;
};

} // namespace pliant
