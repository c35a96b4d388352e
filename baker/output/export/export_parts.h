// What the parts of an export share.
#pragma once

#include "output/export/export_primitives.h"
#include "output/export/grid_mesh.h"

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

// Pose 0 as the options want it stored. Fills in the grid of whole numbers and its error.
StoredVertices stored_rest(const DrawnSpace& space, const ExportOptions& options, ExportReport& report, Grid& grid);

// Add the mesh and all that moves it, fill in what the report has of it and, for whole numbers, their grid. Return the mesh;
// node 0 must become its node. The first adds morph targets, with an animation of their weights. The second fits bones to
// the reachable shapes and adds skin 0, which node 0 must have, the joint nodes from node 1 on, and their animation.
Glb::Json add_morph_mesh(Glb& glb, RuntimeBlender& blender, const DrawnSpace& space, const RenderScene& scene,
                         const ExportOptions& options, ExportReport& report, Grid& grid);
Glb::Json add_skinned_mesh(Glb& glb, RuntimeBlender& blender, const DrawnSpace& space, const RenderScene& scene,
                           const ExportOptions& options, ExportReport& report, Grid& grid);

} // namespace pliant
