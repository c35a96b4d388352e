#include "base/mesh/tets.h"

#include <Eigen/LU>

namespace pliant {

Eigen::Matrix3d tet_edges(const Shape& shape, const Tetrahedron& tet)
{
    const Eigen::Vector3d origin = point(shape, tet[0]);
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = point(shape, tet[std::size_t(i) + 1]) - origin;
    return edges;
}

Eigen::VectorXd tet_volumes(const Shape& shape, const std::vector<Tetrahedron>& tets)
{
    Eigen::VectorXd volumes(tets.size());
    for (std::size_t t = 0; t < tets.size(); ++t) volumes[Eigen::Index(t)] = tet_edges(shape, tets[t]).determinant() / 6;
    return volumes;
}

Eigen::VectorXd lumped_tet_masses(const Shape& shape, const std::vector<Tetrahedron>& tets)
{
    const Eigen::VectorXd volumes = tet_volumes(shape, tets);
    Eigen::VectorXd masses = Eigen::VectorXd::Zero(shape.size() / 3);
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (std::uint32_t v : tets[t]) masses[v] += volumes[Eigen::Index(t)] / 4;
    return masses;
}

Eigen::VectorXd cell_masses(const NormalizedPoses& set, const Shape& shape)
{
    if (set.is_solid()) return lumped_tet_masses(shape, set.tets);
    Eigen::VectorXd masses = lumped_masses(shape, set.triangles);
    const double least = lone_vertex_mass * masses.mean();
    for (double& mass : masses)
        if (mass == 0) mass = least;
    return masses;
}

Eigen::VectorXd cell_sizes(const NormalizedPoses& set, const Shape& shape)
{
    return set.is_solid() ? tet_volumes(shape, set.tets) : triangle_areas(shape, set.triangles);
}

} // namespace pliant
