// Poses the character: every part is bent and twisted along its axis, and the skin follows.
#pragma once

#include "anatomy.h"
#include "poses.h"

namespace pliant::creature {

// Where one part goes: a map of space that carries each cross-section of the bind axis rigidly onto the bent axis. Lengths
// along the axis are kept exactly.
class BentAxis {
public:
    // `root` and `root_frame` (columns tangent, side, up) are where the axis' parameter 0 goes.
    BentAxis(const Part& part, const std::vector<Bend>& bends, const Vec3& root, const Mat3& root_frame);
    Vec3 map(const Vec3& bind_point) const;
    // How directions at parameter s of the bind axis turn.
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

// Per vertex and part: how much the part carries the vertex. Weights are smooth over the mesh, non-negative, and sum to 1.
Eigen::MatrixXd skin_weights(const Mesh& bind, const Anatomy& anatomy);

// The bind shape's vertices in a pose.
std::vector<Vec3> pose_points(const Mesh& bind, const Anatomy& anatomy, const Eigen::MatrixXd& weights, const Pose& pose);

} // namespace pliant::creature
