// A morph mesh in bytes and shorts, as KHR_mesh_quantization stores it: places are origin + step * whole numbers.
#pragma once

#include "output/export/grid_rounding.h"
#include "output/export/morph_mesh.h"

namespace pliant {

struct Grid {
    double step = 0; // input units; a float's value
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();

    // 3n places as whole steps from the origin, not rounded.
    Eigen::VectorXd steps_of(const Eigen::VectorXd& positions) const;
};

struct GridMesh {
    Grid grid;
    Integers positions; // 3n x (d + 1): deltas and base
    Integers normals;   // the same in steps of 1/127 of a unit vector
    double error = 0;   // largest distance of a vertex from its place in the sampled shapes, of the diagonal
    NormalError normal_error;
};

// Rounds positions to the coarsest grid found that keeps every vertex of the sampled shapes within `error` (of the diagonal)
// of its place, and normals to bytes. Throws Failure (usage, P5207) if 16 bits are too few for that. Cost: some ten times
// the shapes of all samples.
GridMesh make_grid_mesh(const MorphMesh& mesh, const DrawnSpace& space, double error);

// For a mesh without targets: no vertex is farther than `error` of the diagonal from its place. P5207.
Grid grid_for(const Eigen::VectorXd& positions, double error);

// Positions become whole steps. Returns the largest distance of a vertex from its place, of the diagonal.
double round_to(const Grid& grid, Eigen::VectorXd& positions);

} // namespace pliant
