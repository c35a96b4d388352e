// From poses as they came to the problem that is solved: rigidly aligned, centred, in units of the character.
#pragma once

#include "base/mesh/surface.h"

namespace pliant {

// x -> rotation * x + translation.
struct RigidMotion {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// The proper rigid motion that brings `from` closest to `to` in the sum of masses times squared distances (Kabsch 1976).
RigidMotion best_rigid_motion(const Shape& from, const Shape& to, const Eigen::VectorXd& masses);

void apply(const RigidMotion& motion, Shape& shape);

// The normalised problem. Lengths are in units of `length` (the root of the mean surface area of the poses, the cube root of the mean
// volume of a solid) around `origin` (the centroid of pose 0), so that nothing depends on the units of the files or on where the
// character stands.
struct ShapeSet {
    std::vector<Triangle> triangles;            // of a solid: its boundary
    std::vector<Tetrahedron> tets;              // empty: a surface
    SolidRegions regions;                       // of a solid
    std::vector<std::uint32_t> source_vertices; // as in PoseSet
    std::vector<std::uint32_t> fixed_vertices;  // ascending; without them bodies are free
    std::vector<Shape> shapes;                  // per pose, aligned to pose 0
    Eigen::VectorXd masses;                     // per vertex: lumped, mean over the poses; sum 1; all positive
    Eigen::Vector3d origin;                     // input units; each coordinate is exactly a float
    double length = 1;                          // input units
    std::vector<RigidMotion> motions;           // what was applied to each pose, in input units
    double diagonal = 1;                        // bounding-box diagonal of pose 0, normalised units

    bool is_solid() const { return !tets.empty(); }
    bool is_free() const { return fixed_vertices.empty(); }
    std::size_t pose_count() const { return shapes.size(); }
    Eigen::Index dof_count() const { return shapes[0].size(); }
};

// Moves `shape` rigidly to where it is closest to `target`, unless fixed vertices hold it.
void align_to(const ShapeSet& set, const Shape& target, Shape& shape);

// Aligns (unless `keep_placement`, or vertices are fixed) and normalises.
ShapeSet normalise(const PoseSet& poses, bool keep_placement = false);

// Back to input units and place.
Positions to_input_units(const ShapeSet& set, const Shape& shape);

// The inverse for positions as the runtime writes them (3n floats): a shape in normalised units.
Shape from_input_units(const ShapeSet& set, const std::vector<float>& positions);

} // namespace pliant
