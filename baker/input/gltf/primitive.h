// One drawn part of a glTF mesh: its triangles and what its vertices carry.
#pragma once

#include "base/mesh/pose_set.h"
#include "input/gltf/accessor.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pliant {

struct GltfPrimitive {
    explicit GltfPrimitive(GltfValue list_of_targets)
        : targets(std::move(list_of_targets))
    {
    }

    std::ptrdiff_t material = -1;
    std::vector<Triangle> triangles;               // corners below vertex_count()
    GltfNumbers positions;                         // n x 3, finite or not: whoever shows them checks
    double position_step = 0, weight_step = 0;     // of the grids that they and weights were rounded to; 0: none
    int short_bits = 0;                            // of positions in normalized shorts, without the sign; 0: in others
    std::map<std::string, GltfNumbers> attributes; // NORMAL (n x 3), TEXCOORD_k (n x 2), COLOR_k (n x 3 or 4)
    // Influences of joints, `joint_count` a vertex: numbers into the skin's list, and weights as the file has them.
    std::vector<std::uint32_t> joints;
    GltfNumbers weights; // n x joint_count; 0 columns: not skinned
    GltfValue targets;   // a list, read when its elements are needed: they may name one array a thousand times

    std::uint64_t stored_count = 0; // vertices in the file, of which the first vertex_count() are the mesh

    std::uint64_t vertex_count() const { return static_cast<std::uint64_t>(positions.rows()); }
    std::uint64_t number_count() const; // of what every node that shows it draws: positions, attributes and triangles
};

// Reads primitives with mode TRIANGLES, TRIANGLE_STRIP or TRIANGLE_FAN. Without indices corners are vertices 0, 1, 2, ...
// Strips and fans become triangles, in order. What `pliant export` adds for the bounds of engines (behind
// extras.pliant.vertex_count) is left out. What is read is taken from `allowance`. Throws Failure: P2306 to P2308, P2311,
// P2315 (corner out of range), P2317, P2318, P2333.
GltfPrimitive read_primitive(const GltfDocument& document, const GltfValue& primitive, GltfAllowance& allowance);

// Whether a primitive is of triangles at all. P2306 for a mode that there is not.
bool has_triangles(const GltfValue& primitive);

} // namespace pliant
