// Sample points of the surfaces of parts. With vertices alone, a part that stands in the middle of a large face would seem
// far away from it.
#pragma once

#include "elastic/parts/parts.h"

namespace pliant {

constexpr std::uint32_t no_face = ~std::uint32_t(0);

struct PartPoints {
    // 3m x p, pose space (base/mesh/point_tree.h): all vertices of the set, then the sample points of large faces.
    Eigen::MatrixXd columns;
    std::vector<std::vector<std::uint32_t>> of_part; // the columns of each part, its vertices first
    std::vector<std::uint32_t> faces;                // per column: the face that was sampled, or no_face for a vertex
};

// `vertices`: the set in pose space, 3m x n. Faces with an edge longer than `spacing` (normalized length) are sampled at
// that distance, or more coarsely if that would give more than 20,000 points plus two per vertex. Cost: linear in the number
// of points.
PartPoints sample_parts(const Eigen::MatrixXd& vertices, const std::vector<Triangle>& faces, const Parts& parts,
                        double spacing);

} // namespace pliant
