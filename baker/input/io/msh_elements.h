// The types of elements in Gmsh's files.
#pragma once

#include <cstdint>

namespace pliant {

struct MshElement {
    std::int64_t type;
    int dimension;
    int node_count;
    const char* name; // of many, if they are left out; of one, if they are refused
    bool is_tet = false;
};

// The entry of a type, or null if we know none.
inline const MshElement* find_msh_element(std::int64_t type)
{
    // clang-format off
    static constexpr MshElement table[] = {
        { 15, 0, 1, "points" },
        { 1, 1, 2, "lines" }, { 8, 1, 3, "lines" }, { 26, 1, 4, "lines" }, { 27, 1, 5, "lines" }, { 28, 1, 6, "lines" },
        { 2, 2, 3, "triangles" }, { 9, 2, 6, "triangles" }, { 20, 2, 9, "triangles" }, { 21, 2, 10, "triangles" },
        { 22, 2, 12, "triangles" }, { 23, 2, 15, "triangles" }, { 24, 2, 15, "triangles" }, { 25, 2, 21, "triangles" },
        { 3, 2, 4, "quadrilaterals" }, { 10, 2, 9, "quadrilaterals" }, { 16, 2, 8, "quadrilaterals" },
        { 4, 3, 4, "a tetrahedron", true },
        { 11, 3, 10, "a tetrahedron with 10 nodes" }, { 29, 3, 20, "a tetrahedron with 20 nodes" },
        { 30, 3, 35, "a tetrahedron with 35 nodes" }, { 31, 3, 56, "a tetrahedron with 56 nodes" },
        { 5, 3, 8, "a hexahedron" }, { 12, 3, 27, "a hexahedron with 27 nodes" }, { 17, 3, 20, "a hexahedron with 20 nodes" },
        { 92, 3, 64, "a hexahedron with 64 nodes" }, { 93, 3, 125, "a hexahedron with 125 nodes" },
        { 6, 3, 6, "a prism" }, { 13, 3, 18, "a prism with 18 nodes" }, { 18, 3, 15, "a prism with 15 nodes" },
        { 7, 3, 5, "a pyramid" }, { 14, 3, 14, "a pyramid with 14 nodes" }, { 19, 3, 13, "a pyramid with 13 nodes" },
    };
    // clang-format on
    for (const MshElement& element : table) {
        if (element.type == type) return &element;
    }
    return nullptr;
}

} // namespace pliant
