#include "bake/choose_material.h"

#include "base/common/diagnostics.h"

#include <fmt/core.h>

namespace pliant {

namespace {

// Edges of a surface of unit area with so many vertices are ten times as long as the default shell is thick: its folds are
// then no wider than a triangle, and what decides between them is the triangulation.
constexpr std::size_t few_vertices = 4000;

bool is_default(const ShellOptions& shell)
{
    const ShellOptions standard;
    return shell.membrane == standard.membrane && shell.thickness == standard.thickness
        && shell.foldover_damping == standard.foldover_damping;
}

bool is_of_solids(Material material) { return material == Material::stvk || material == Material::mooney_rivlin; }

void require_sort(Material material, bool is_solid)
{
    if (is_of_solids(material) == is_solid) return;
    throw Failure(ExitCode::usage,
                  error_at(1206, "",
                           fmt::format("--material {} is for {}, the poses are {}", name_of(material),
                                       is_solid ? "surfaces" : "solids", is_solid ? "solids" : "surfaces"),
                           is_solid ? "use stvk or mooney-rivlin" : "use discrete-shells or arap"));
}

} // namespace

MaterialChoice choose_material(const EnergyOptions& options, bool is_solid, std::size_t vertex_count)
{
    if (options.material) {
        require_sort(*options.material, is_solid);
        return { *options.material, "" };
    }
    if (is_solid) return { Material::stvk, "" };
    if (options.continuity == Continuity::off || !is_default(options.shell)) return { Material::discrete_shells, "" };
    return { vertex_count <= few_vertices ? Material::arap : Material::discrete_shells,
             fmt::format("a surface of {} vertices", vertex_count) };
}

} // namespace pliant
