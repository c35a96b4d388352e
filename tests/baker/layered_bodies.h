// Bodies with two layers that fit together: each moves a third of the body and the rest of it rigidly.
#pragma once

#include "parts_mesh.h"
#include "twisted_bar.h"

namespace pliant {

// Where a point at height z in [0, 6] goes when the lowest third is twisted about the z axis and the highest third bent in
// the xz plane, by these angles (radians).
inline Eigen::RowVector3d layered_place(double twist, double bend, double x, double y, double z)
{
    const double phi = bend * std::max(z - 4, 0.0) / 2, turn = twist * std::clamp(z, 0.0, 2.0) / 2;
    if (std::abs(bend) > 1e-9 && z > 4) {
        const double radius = 2 / bend, out = radius - x;
        x = radius - out * std::cos(phi);
        z = 4 + out * std::sin(phi);
    }
    return { std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y, z };
}

inline Positions layered_positions(const Positions& straight, double twist, double bend)
{
    Positions out = straight;
    for (Eigen::Index v = 0; v < out.rows(); ++v)
        out.row(v) = layered_place(twist, bend, straight(v, 0), straight(v, 1), straight(v, 2));
    return out;
}

// The straight body, that with the lowest third twisted, that with the highest third bent.
inline void set_layers(PoseSet& poses, double twist = 1.5, double bend = 1.5)
{
    const Positions straight = poses.positions[0];
    poses.blend = Blend::layers;
    poses.positions = { straight, layered_positions(straight, twist, 0), layered_positions(straight, 0, bend) };
    poses.names = { "straight", "twisted", "bent" };
    poses.paths = poses.names;
}

inline PoseSet layered_tube(const Tube& tube = {})
{
    PoseSet poses = tube_poses(1, tube);
    set_layers(poses);
    return poses;
}

// With a sphere inside, a jacket, and a vertex without a face.
inline PoseSet layered_parts()
{
    PartsMesh mesh;
    mesh.body = { 13, 8 };
    PoseSet poses = mesh.poses(1);
    set_layers(poses);
    return poses;
}

inline PoseSet layered_bar()
{
    PoseSet poses = twisted_bar(1, 6, 0);
    set_layers(poses);
    return poses;
}

} // namespace pliant
