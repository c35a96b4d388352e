#include "reduced/surrogate/ghost.h"

#include "base/mesh/decimate.h"
#include "base/mesh/surface.h"

namespace pliant {

Ghost make_ghost(const NormalizedPoses& set, const Subspace& subspace, std::size_t vertex_count)
{
    require_manifold(set.triangles, std::size_t(set.dof_count() / 3), set.source_vertices, "--energy ghost",
                     "repair it the same way in all poses, or use --energy cubature, which does not need one");
    CoarsePoses coarse = decimate(set, vertex_count);
    const Eigen::Index n = Eigen::Index(coarse.vertices.size());
    Eigen::MatrixXd basis(3 * n, subspace.dimension());
    for (Eigen::Index v = 0; v < n; ++v)
        basis.middleRows<3>(3 * v) = subspace.basis.middleRows<3>(3 * Eigen::Index(coarse.vertices[std::size_t(v)]));
    return { std::move(coarse.set), std::move(coarse.vertices), std::move(basis) };
}

} // namespace pliant
