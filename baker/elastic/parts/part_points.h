// The surfaces of parts as points, so that a part that lies on a large face of another is near it.
#pragma once

#include "elastic/parts/parts.h"

namespace pliant {

constexpr std::uint32_t no_face = ~std::uint32_t(0);

struct PartPoints {
    Eigen::MatrixXd columns; // pose space (base/mesh/point_tree.h): of the vertices, then points of large faces
    std::vector<std::vector<std::uint32_t>> of_part; // columns; its vertices first
    std::vector<std::uint32_t> faces;                // per column: the face that it is a point of; no_face: a vertex
};

// `vertices`: the pose space of the set. Faces longer than `spacing` get points that far apart, or farther where that would make many more
// points than there are vertices.
PartPoints sample_parts(const Eigen::MatrixXd& vertices, const std::vector<Triangle>& faces, const Parts& parts,
                        double spacing);

} // namespace pliant
