// The poses as the method sees them.
#pragma once

#include "base/mesh/surface.h"
#include "base/weights/weights.h"

namespace pliant {

// x -> rotation * x + translation.
struct RigidMotion {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// The normalized problem. Lengths are in units of `length` (the root of the mean surface area of the poses, the cube root of
// the mean volume of a solid) around `centre` (the centroid of pose 0), so that nothing depends on the units of the files or
// on where the character stands.
struct NormalizedPoses {
    std::vector<Triangle> triangles;            // of a solid: its boundary
    std::vector<Tetrahedron> tets;              // empty: a surface
    SolidRegions regions;                       // of a solid
    std::vector<std::uint32_t> source_vertices; // as in PoseSet
    std::vector<std::uint32_t> fixed_vertices;  // ascending; without them bodies are free
    std::vector<Shape> shapes;                  // per pose, aligned to pose 0 unless there is a frame
    Shape frame;                                // of free poses that stay where they are, a shape between them; else empty
    Eigen::VectorXd masses;                     // per vertex: lumped, mean over the poses; sum 1; all positive
    Eigen::Vector3d centre;                     // input units; each coordinate is exactly a float
    double length = 1;                          // input units
    std::vector<RigidMotion> motions;           // what was applied to each pose, in input units
    double diagonal = 1;                        // bounding-box diagonal of pose 0, normalized units

    bool is_solid() const { return !tets.empty(); }
    bool is_free() const { return fixed_vertices.empty(); }
    std::size_t pose_count() const { return shapes.size(); }
    Eigen::Index dof_count() const { return shapes[0].size(); }
};

// The linear blend: the weighted mean of the poses; of layers the rest shape and the weighted differences from it.
Shape linear_blend(const NormalizedPoses& set, const Weights& w);

} // namespace pliant
