#include "output/asset/check_render_mesh.h"

#include "elastic/average/shape_error.h"
#include "output/asset/runtime_blender.h"

#include <algorithm>

namespace pliant {

RenderMeshErrors check_render_mesh(RuntimeBlender& blender, const NormalizedPoses& solid, const RenderMesh& surface,
                                   const std::vector<CheckPoint>& checks)
{
    const NormalizedPoses set = render_mesh_shapes(solid, surface);
    RenderMeshErrors errors;
    for (const CheckPoint& check : checks) {
        const Eigen::VectorXf w = check.weights.cast<float>();
        const std::vector<float> q = blender.solve(std::vector<float>(w.data(), w.data() + w.size()), false);
        const ShapeError error
            = shape_distance(set, from_input_units(set, blender.positions(q)), apply(surface.embedding, check.reference));
        errors.mean += error.relative_l2 / double(checks.size());
        errors.largest = std::max(errors.largest, error.relative_l2);
        errors.largest_distance = std::max(errors.largest_distance, error.largest_distance);
    }
    return errors;
}

} // namespace pliant
