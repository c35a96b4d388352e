// A character in several parts: the tube of tube.h as the body, with an eye inside, a jacket around, a button far from
// everything it could touch, and a vertex without a face.
#pragma once

#include "tube.h"

namespace pliant {

struct PartsMesh {
    bool has_eye = true, has_jacket = true, has_vertex = true;
    double eye_turn = 0.5; // radians between two poses
    Tube body = {};

    PoseSet poses(std::size_t count) const
    {
        static const double bends[] = { 0, 1.6, 0.4, -1.2 }, twists[] = { 0, 0, 1.5, 0.6 };
        PoseSet out = tube_poses(count, body);
        std::vector<std::vector<Eigen::RowVector3d>> added(count);
        const std::size_t body_count = out.vertex_count();
        std::vector<Triangle> faces;
        std::uint32_t first = std::uint32_t(body_count);
        const auto add = [&](std::uint32_t rings, std::uint32_t sides, bool is_closed, const auto& at) {
            for (std::size_t k = 0; k < count; ++k)
                for (std::uint32_t r = 0; r < rings; ++r)
                    for (std::uint32_t s = 0; s < sides; ++s) added[k].push_back(at(k, r, s));
            for (std::uint32_t r = 0; r + 1 < rings; ++r)
                for (std::uint32_t s = 0; s + (is_closed ? 0 : 1) < sides; ++s) {
                    const std::uint32_t a = first + r * sides + s, b = first + r * sides + (s + 1) % sides;
                    faces.push_back({ a, b, b + sides });
                    faces.push_back({ a, b + sides, a + sides });
                }
            first += rings * sides;
        };
        if (has_eye) // open at the poles, so that it is a sphere of bands; it turns about y while the body bends
            add(6, 8, true, [&](std::size_t k, std::uint32_t r, std::uint32_t s) {
                const double polar = 0.3 + r * (3.14159265 - 0.6) / 5, around = 6.283185307179586 * s / 8,
                             turn = eye_turn * double(k);
                const double x = 0.2 * std::sin(polar) * std::cos(around), y = 0.2 * std::sin(polar) * std::sin(around),
                             z = -0.2 * std::cos(polar);
                return Tube::place(bends[k], twists[k], 4.5 + std::cos(turn) * z - std::sin(turn) * x,
                                   0.15 + std::cos(turn) * x + std::sin(turn) * z, y);
            });
        if (has_jacket) // slides along the body from pose to pose
            add(9, 12, true, [&](std::size_t k, std::uint32_t r, std::uint32_t s) {
                const double around = 6.283185307179586 * (s + 0.5 * r) / 12;
                return Tube::place(bends[k], twists[k], 1.5 + 0.05 * double(k) + 0.25 * r, 0.56 * std::cos(around),
                                   0.56 * std::sin(around));
            });
        if (has_vertex)
            for (std::size_t k = 0; k < count; ++k) added[k].push_back(Tube::place(bends[k], twists[k], 0.5, 0.8, 0.1));
        append(out, added, faces);
        return out;
    }

private:
    static void append(PoseSet& poses, const std::vector<std::vector<Eigen::RowVector3d>>& added,
                       const std::vector<Triangle>& faces)
    {
        for (std::size_t k = 0; k < poses.pose_count(); ++k) {
            Positions& positions = poses.positions[k];
            const Eigen::Index before = positions.rows();
            positions.conservativeResize(before + Eigen::Index(added[k].size()), 3);
            for (std::size_t i = 0; i < added[k].size(); ++i) positions.row(before + Eigen::Index(i)) = added[k][i];
        }
        for (const Triangle& t : faces) {
            poses.triangles.push_back(t);
            for (const std::uint32_t v : t) poses.polygons.indices.push_back(v);
            poses.polygons.offsets.push_back(std::uint32_t(poses.polygons.indices.size()));
        }
    }
};

} // namespace pliant
