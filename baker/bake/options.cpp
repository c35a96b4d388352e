#include "bake/options.h"

namespace pliant {

void make_preview(BakeOptions& options, bool has_tolerance)
{
    constexpr double preview_tolerance = 5e-3;
    options.time_limit = 0;
    if (!has_tolerance) options.tolerance = preview_tolerance;
}

const char* name_of(Blend blend) { return blend == Blend::layers ? "layers" : "average"; }

const char* name_of(Material material)
{
    switch (material) {
    case Material::arap: return "arap";
    case Material::stvk: return "stvk";
    case Material::mooney_rivlin: return "mooney-rivlin";
    default: return "discrete-shells";
    }
}

const char* name_of(Continuity continuity) { return continuity == Continuity::off ? "off" : "auto"; }

const char* name_of(Membrane membrane)
{
    switch (membrane) {
    case Membrane::stvk: return "stvk";
    case Membrane::edge: return "edge";
    default: return "neo-hookean";
    }
}

const char* name_of(SubspaceKind kind)
{
    return kind == SubspaceKind::krylov ? "krylov" : kind == SubspaceKind::barbic ? "barbic" : "adaptive";
}

const char* name_of(SurrogateKind kind)
{
    switch (kind) {
    case SurrogateKind::quartic: return "quartic";
    case SurrogateKind::cubature: return "cubature";
    case SurrogateKind::ghost: return "ghost";
    default: return "auto";
    }
}

const char* name_of(SolverKind kind) { return kind == SolverKind::eigen ? "eigen" : "cholmod"; }

} // namespace pliant
