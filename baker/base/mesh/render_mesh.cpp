#include "base/mesh/render_mesh.h"

#include "base/mesh/surface.h"

namespace pliant {

std::shared_ptr<const RenderMesh> copy_to_render_mesh(Polygons polygons, std::vector<Triangle> triangles,
                                                      const std::vector<std::uint32_t>& places)
{
    auto surface = std::make_shared<RenderMesh>();
    surface->polygons = std::move(polygons);
    surface->triangles = std::move(triangles);
    const Eigen::Index count = static_cast<Eigen::Index>(places.size());
    for (const std::uint32_t v : places) surface->embedding.corners.push_back({ v, v, v, v });
    surface->embedding.weights.setZero(4, count);
    surface->embedding.weights.row(0).setOnes();
    surface->embedding.distances.setZero(count);
    return surface;
}

Positions render_mesh_positions(const RenderMesh& surface, const Positions& positions)
{
    const Shape drawn = apply(surface.embedding, Eigen::Map<const Shape>(positions.data(), positions.size()));
    return Eigen::Map<const Positions>(drawn.data(), drawn.size() / 3, 3);
}

NormalizedPoses render_mesh_shapes(const NormalizedPoses& solid, const RenderMesh& surface)
{
    NormalizedPoses set;
    set.triangles = surface.triangles;
    set.fixed_vertices = solid.fixed_vertices;
    set.centre = solid.centre;
    set.length = solid.length;
    set.motions = solid.motions;
    set.masses = Eigen::VectorXd::Zero(Eigen::Index(surface.embedding.count()));
    for (const Shape& shape : solid.shapes) {
        set.shapes.emplace_back(apply(surface.embedding, shape));
        set.masses += lumped_masses(set.shapes.back(), set.triangles) / double(solid.pose_count());
    }
    if (solid.frame.size() > 0) set.frame = apply(surface.embedding, solid.frame);
    set.masses /= set.masses.sum();
    const Eigen::Map<const Positions> rest(set.shapes[0].data(), set.shapes[0].size() / 3, 3);
    set.diagonal = box_diagonal(rest);
    return set;
}

} // namespace pliant
