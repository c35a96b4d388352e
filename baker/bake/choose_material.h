// The material of poses for which none was asked.
#pragma once

#include "bake/options.h"
#include "base/common/progress.h"
#include "base/mesh/normalized_poses.h"

#include <string>

namespace pliant {

// The material that options mean without a look at the poses; none: choose_material measures. Throws Failure (usage, P1206)
// for one of the other sort.
std::optional<Material> stated_material(const EnergyOptions& options, bool is_solid);

struct MaterialChoice {
    Material material;
    std::string reason; // where there was a choice: what was seen, for people
};

// Of surfaces without a stated material the one whose averages are continuous (elastic/THEORY.md, section 10): discrete
// shells if, on a coarse mesh, every average that is tried is found from two sides, else ARAP; ARAP also for meshes too
// coarse for wrinkles; shells for larger ones that cannot be made coarser. Depends on the poses only, so all who mean these
// poses mean the same energy. Cost: some hundred factorisations of a mesh of 2,000 vertices.
MaterialChoice choose_material(const NormalizedPoses& set, const EnergyOptions& options, Progress* progress);

} // namespace pliant
