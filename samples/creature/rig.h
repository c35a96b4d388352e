// Poses the character: every part is bent and twisted along its axis, and the skin follows.
#pragma once

#include "anatomy.h"
#include "poses.h"

namespace pliant::creature {

// The deformation of one part: maps each cross-section of the bind axis rigidly onto the bent axis. Lengths along the
// axis are kept exactly.
class BentAxis {
public:
    // root, root_frame (columns tangent, side, up): position and frame of the bent axis at parameter 0.
    BentAxis(const Part& part, const std::vector<Bend>& bends, const Vec3& root, const Mat3& root_frame);
    Vec3 map(const Vec3& bind_point) const;
    // The rotation of directions at parameter s of the bind axis.
    Mat3 rotation(double s) const;

private:
    struct Sample {
        Vec3 position;
        Mat3 frame; // rotation-minimising
        double twist;
    };
    Sample sample(double s) const;

    Axis axis_;
    double first_, step_;
    std::vector<Sample> samples_;
};

// Skinning weights, a row per vertex and a column per part: smooth over the mesh, non-negative, with sum 1.
Eigen::MatrixXd skin_weights(const Mesh& bind, const Anatomy& anatomy);

// The vertices of the bind shape in a pose.
std::vector<Vec3> pose_points(const Mesh& bind, const Anatomy& anatomy, const Eigen::MatrixXd& weights, const Pose& pose);

} // namespace pliant::creature
