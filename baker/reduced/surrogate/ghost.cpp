#include "reduced/surrogate/ghost.h"

#include "base/common/diagnostics.h"

namespace pliant {

Ghost make_ghost(const NormalizedPoses& set, const Subspace& subspace, std::size_t vertex_count)
{
    require_manifold(set.triangles, std::size_t(set.dof_count() / 3), set.source_vertices, "--energy ghost",
                     "repair it the same way in all poses, or use --energy cubature, which does not need one");
    DecimatedPoses coarse = decimate(set, vertex_count);
    if (coarse.failed_face)
        throw Failure(
            ExitCode::bad_input,
            error_at(4503, "",
                     "face " + std::to_string(*coarse.failed_face) + " cannot be joined to its neighbours for decimation",
                     "use --energy cubature, which needs no half-edges"));
    Ghost ghost { std::move(coarse.set), std::move(coarse.vertices), {} };
    ghost.basis.resize(ghost.set.dof_count(), subspace.dimension());
    for (std::size_t v = 0; v < ghost.vertices.size(); ++v)
        ghost.basis.middleRows<3>(3 * Eigen::Index(v)) = subspace.basis.middleRows<3>(3 * Eigen::Index(ghost.vertices[v]));
    return ghost;
}

} // namespace pliant
