// The material of poses for which none was asked.
#pragma once

#include "bake/options.h"

#include <string>

namespace pliant {

struct MaterialChoice {
    Material material;
    std::string reason; // for people; empty: the options state it
};

// What the options state, else stvk for solids, ARAP for surfaces of few vertices and discrete shells for others
// (elastic/THEORY.md, section 10). `vertex_count` of the simulation mesh. Throws Failure (usage, P1206) for a material of
// the other sort.
MaterialChoice choose_material(const EnergyOptions& options, bool is_solid, std::size_t vertex_count);

} // namespace pliant
