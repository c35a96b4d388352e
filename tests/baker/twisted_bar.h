// A bar of tetrahedra, straight and twisted: the paper's example (von Tycowicz et al. 2015, Table II).
#pragma once

#include "base/mesh/solid.h"

#include <cmath>

// Box [-.5, .5]^2 x [0, 6] of cells x cells x length_cells cubes, five tetrahedra each, alternating so that faces meet. Pose
// 1 turns the cross-section at height z by angle * z / 6. Vertices are those of the grid, not numbered anew.
inline pliant::PoseSet twisted_bar(int cells, int length_cells, double angle)
{
    const int n = cells + 1, layers = length_cells + 1;
    const auto vertex = [&](int i, int j, int k) { return std::uint32_t((k * n + j) * n + i); };
    pliant::PoseSet poses;
    poses.names = { "straight", "twisted" };
    poses.paths = poses.names;
    poses.positions.assign(2, pliant::Positions(n * n * layers, 3));
    for (int k = 0; k < layers; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const double x = double(i) / cells - 0.5, y = double(j) / cells - 0.5, z = 6.0 * k / length_cells;
                const double turn = angle * z / 6;
                poses.positions[0].row(vertex(i, j, k)) << x, y, z;
                poses.positions[1].row(vertex(i, j, k)) << std::cos(turn) * x - std::sin(turn) * y,
                    std::sin(turn) * x + std::cos(turn) * y, z;
            }
    for (int k = 0; k < length_cells; ++k)
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i) {
                // Corner bits x y z; the inner tetrahedron takes every other corner.
                const auto c = [&](int bits) { return vertex(i + (bits & 1), j + ((bits >> 1) & 1), k + (bits >> 2)); };
                if ((i + j + k) % 2 == 0) {
                    poses.tets.push_back({ c(0), c(1), c(2), c(4) });
                    poses.tets.push_back({ c(3), c(2), c(1), c(7) });
                    poses.tets.push_back({ c(5), c(1), c(4), c(7) });
                    poses.tets.push_back({ c(6), c(4), c(2), c(7) });
                    poses.tets.push_back({ c(1), c(2), c(4), c(7) });
                } else {
                    poses.tets.push_back({ c(1), c(3), c(0), c(5) });
                    poses.tets.push_back({ c(2), c(0), c(3), c(6) });
                    poses.tets.push_back({ c(4), c(0), c(6), c(5) });
                    poses.tets.push_back({ c(7), c(5), c(6), c(3) });
                    poses.tets.push_back({ c(0), c(3), c(6), c(5) });
                }
            }
    // Corners in the order of positive volume.
    for (pliant::Tetrahedron& t : poses.tets) {
        const pliant::Positions& x = poses.positions[0];
        const Eigen::RowVector3d a = x.row(t[1]) - x.row(t[0]), b = x.row(t[2]) - x.row(t[0]), d = x.row(t[3]) - x.row(t[0]);
        if (a.cross(b).dot(d) < 0) std::swap(t[2], t[3]);
    }
    poses.triangles = pliant::boundary_of(poses.tets);
    poses.polygons = pliant::to_polygons(poses.triangles);
    poses.boundary_vertex_count = poses.vertex_count();
    return poses;
}
