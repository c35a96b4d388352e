// Makes an asset from a fitted model: the mesh that it draws, and the basis in few bits. Called by the self-check.
#pragma once

#include "bake/fit.h"
#include "output/asset/asset_writer.h"

namespace pliant {

// Coordinates of the training averages, then of the poses (d x samples): their convex hull is about what blends reach.
Eigen::MatrixXd reachable_coordinates(const FittedModel& fitted);

// The mesh of the poses, as the solver has it: a bake is checked on it.
StoredMesh simulation_mesh(const PoseSet& poses, const NormalizedPoses& set, const BakeOptions& options);

// The mesh that the asset draws where that is another one: a surface of its own (options.render_mesh), or the files'
// vertices and faces. Null: it draws the simulation mesh.
std::shared_ptr<const RenderMesh> render_mesh_of(const PoseSet& poses, const BakeOptions& options);
StoredMesh stored_render_mesh(const RenderMesh& drawn, const PoseSet& poses, const BakeOptions& options);

// The asset with this mesh, its basis within options.position_error at `reachable`.
AssetModel assemble(const NormalizedPoses& set, const WeightDomain& domain, const FittedModel& fitted, StoredMesh mesh,
                    const PoseSet& poses, const Eigen::MatrixXd& reachable, const BakeOptions& options);

} // namespace pliant
