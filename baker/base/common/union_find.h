// Which things belong together (Tarjan 1975, with path halving).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace pliant {

class UnionFind {
public:
    explicit UnionFind(std::size_t count)
        : parents_(count)
    {
        std::iota(parents_.begin(), parents_.end(), std::uint32_t(0));
    }
    std::uint32_t find(std::uint32_t i)
    {
        while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) { parents_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

private:
    std::vector<std::uint32_t> parents_;
};

} // namespace pliant
