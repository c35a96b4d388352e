// Growing little-endian bytes. (The baker runs on little-endian machines; the format is.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

class Bytes {
public:
    template <class T> void put(const T& value)
    {
        const auto* p = reinterpret_cast<const std::uint8_t*>(&value);
        data.insert(data.end(), p, p + sizeof(T));
    }
    void put_float(double value) { put(float(value)); }
    void align(std::size_t alignment) { data.resize((data.size() + alignment - 1) / alignment * alignment, 0); }
    std::vector<std::uint8_t> data;
};

} // namespace pliant
