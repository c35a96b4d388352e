// The energy that options ask for.
#pragma once

#include "bake/options.h"
#include "base/common/progress.h"
#include "base/mesh/normalized_poses.h"
#include "elastic/average/prolongation.h"

namespace pliant {

// What the options state, else stvk for solids and discrete shells for surfaces. Throws Failure (usage, P1206) for a
// material of the other sort.
Material material_of(const EnergyOptions& options, bool is_solid);

// The energy of a shape set. The set must outlive it. Throws as material_of. Of a character in several parts it costs some
// averages (elastic/parts/calibrate_ties.h). The ties of layers keep their first stiffness, and a joint replaces
// those of every part that has one: there is no average to calibrate them by.
std::unique_ptr<Energy> make_energy(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress = nullptr);

// The same energy, and the coarse mesh on which the mean of the poses is searched. Null: of layers, which have no mean, of
// small meshes, of solids, of poses with fixed vertices, of surfaces that cannot be decimated, and where a decimated
// character would have no ties.
struct ElasticModel {
    std::unique_ptr<Energy> energy;
    std::unique_ptr<CoarseBody> coarse;
};
ElasticModel make_model(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress = nullptr);

// The options of a bake with their material. Throws Failure (usage, P1206 to P1208) for a surrogate energy
// that the material does not have, and (bad_input, P2222) for a ghost of a surface that is no manifold.
BakeOptions resolve_options(const BakeOptions& given, const PoseSet& poses);

} // namespace pliant
