// A table from weights of poses or layers to morph weights, for programs without the runtime: some lines of script evaluate
// it.
#pragma once

#include "base/weights/radial_function.h"
#include "output/export/morph_mesh.h"

namespace pliant {

struct PoseTable {
    RadialFunction function; // its numbers are those of the file, rounded: to six decimals where weights end at 1
    double mean_error = 0, largest_error = 0; // distance of vertices from the blends at fresh weights, of the diagonal
};

// Adds centres where the morph weights of blends are farthest from the table's, until the mean error is small or there are
// two hundred. Cost: some thousand solves; a second.
PoseTable fit_pose_table(RuntimeBlender& blender, const MorphMesh& mesh);

} // namespace pliant
