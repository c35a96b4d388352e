// The header of a PLY file: which elements follow, in which encoding. Read by read_ply.cpp.
#pragma once

#include "input/io/source_file.h"

namespace pliant::ply {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(Type type);
inline bool is_real(Type type) { return type == Type::float32 || type == Type::float64; }

struct Property {
    std::string name;
    Type type = Type::float32;
    std::optional<Type> count_type; // of a list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::size_t line = 0;
    std::vector<Property> properties;

    const Property* find(std::string_view property) const
    {
        for (const Property& p : properties) {
            if (p.name == property) return &p;
        }
        return nullptr;
    }
};

enum class Encoding { ascii, little_endian, big_endian };

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::size_t body = 0; // offset of the first byte behind the header
    std::size_t line_count = 0;

    const Element* find(std::string_view element) const
    {
        for (const Element& e : elements) {
            if (e.name == element) return &e;
        }
        return nullptr;
    }
};

// Reads and checks the header: everything a mesh needs is declared, and what is declared fits into the bytes that follow.
std::optional<Header> read_header(const SourceFile& file);

} // namespace pliant::ply
