// What the parts of an export share.
#pragma once

#include "output/export/export_primitives.h"

namespace pliant {

template <class Vector> std::vector<float> to_float_list(const Vector& values)
{
    const Eigen::VectorXf floats = values.template cast<float>();
    return std::vector<float>(floats.data(), floats.data() + floats.size());
}

// Times of `count` frames from 0, for the samplers of an animation.
std::size_t add_times(Glb& glb, std::size_t count, double frames_per_second);

// Coordinates along a path of weights, one column a frame, each frame going on from the one before.
Eigen::MatrixXf path_coordinates(RuntimeBlender& blender, const std::vector<std::vector<float>>& path);

// Fits bones to the reachable shapes and adds skin, joint nodes from node 1 on, and the animation of the joints. Returns the
// mesh; node 0 must become its node, with skin 0. Fills in what the report has of bones.
Glb::Json add_skinned_mesh(Glb& glb, RuntimeBlender& blender, const DrawnSpace& space, const RenderScene& scene,
                           const ExportOptions& options, ExportReport& report);

} // namespace pliant
