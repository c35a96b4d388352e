// A closed tube in several poses: small enough for tests that bake, large rotations all the same.
#pragma once

#include "base/mesh/pose_set.h"

#include <cmath>
#include <string>

namespace pliant {

// `ring_count` rings of `side_count` vertices along z in [0, 6], and two cap vertices. Radius 0.5, slightly uneven so that
// no symmetry hides a mistake.
struct Tube {
    std::uint32_t ring_count = 24, side_count = 10;

    std::vector<Triangle> triangles() const
    {
        std::vector<Triangle> out;
        const auto at = [&](std::uint32_t ring, std::uint32_t side) { return ring * side_count + side % side_count; };
        const std::uint32_t bottom = ring_count * side_count, top = bottom + 1;
        for (std::uint32_t s = 0; s < side_count; ++s) {
            for (std::uint32_t r = 0; r + 1 < ring_count; ++r) {
                out.push_back({ at(r, s), at(r, s + 1), at(r + 1, s + 1) });
                out.push_back({ at(r, s), at(r + 1, s + 1), at(r + 1, s) });
            }
            out.push_back({ bottom, at(0, s + 1), at(0, s) });
            out.push_back({ top, at(ring_count - 1, s), at(ring_count - 1, s + 1) });
        }
        return out;
    }

    // Where a point beside the straight tube's axis goes when the tube is bent into an arc of `bend` radians in the xz plane
    // and twisted by `twist` radians from end to end.
    static Eigen::RowVector3d place(double bend, double twist, double z, double x, double y)
    {
        const double angle = twist * z / 6, cx = std::cos(angle) * x - std::sin(angle) * y,
                     cy = std::sin(angle) * x + std::cos(angle) * y;
        if (std::abs(bend) < 1e-9) return Eigen::RowVector3d(cx, cy, z);
        const double radius = 6 / bend, phi = bend * z / 6;
        return Eigen::RowVector3d(radius - (radius - cx) * std::cos(phi), cy, (radius - cx) * std::sin(phi));
    }

    Positions pose(double bend, double twist) const
    {
        Positions out(ring_count * side_count + 2, 3);
        const auto place = [&](double z, double x, double y) { return Tube::place(bend, twist, z, x, y); };
        for (std::uint32_t r = 0; r < ring_count; ++r)
            for (std::uint32_t s = 0; s < side_count; ++s) {
                const double phi = 6.283185307179586 * (s + 0.3 * std::sin(1.0 + r)) / side_count;
                const double radius = 0.5 * (1 + 0.06 * std::sin(2 * phi + 0.7 * r));
                out.row(r * side_count + s)
                    = place(6.0 * r / (ring_count - 1), radius * std::cos(phi), radius * std::sin(phi));
            }
        out.row(ring_count * side_count) = place(0, 0, 0);
        out.row(ring_count * side_count + 1) = place(6, 0, 0);
        return out;
    }
};

inline PoseSet tube_poses(std::size_t count, const Tube& tube = {})
{
    static const double bends[] = { 0, 1.6, 0.4, -1.2 }, twists[] = { 0, 0, 1.5, 0.6 };
    PoseSet poses;
    poses.triangles = tube.triangles();
    for (const Triangle& t : poses.triangles) {
        for (std::uint32_t v : t) poses.polygons.indices.push_back(v);
        poses.polygons.offsets.push_back(std::uint32_t(poses.polygons.indices.size()));
    }
    for (std::size_t k = 0; k < count; ++k) {
        poses.positions.push_back(tube.pose(bends[k], twists[k]));
        poses.names.push_back("pose" + std::to_string(k));
        poses.paths.push_back(poses.names.back() + ".ply");
    }
    return poses;
}

} // namespace pliant
