// The script of pose_solid: plain text, one handle a line, a region of vertices and what happens to it.
//     box    x0 y0 z0 x1 y1 z1    MOTION...
//     sphere x y z r              MOTION...
//     vertices i j k ...          MOTION...
// with the motions, one behind the other,
//     hold | move dx dy dz | turn px py pz ax ay az degrees
// Points are fractions of the bounding box of the rest pose (0 0 0 its lower corner, 1 1 1 its upper one), lengths (r, dx dy dz)
// fractions of its diagonal: a script does not depend on the unit of the mesh. Axes and angles are those of the file. # starts a
// comment.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"

namespace pliant {

struct Region {
    enum class Kind { box, sphere, vertices };
    Kind kind = Kind::box;
    Eigen::Vector3d lower = Eigen::Vector3d::Zero(); // of a box; the centre of a sphere
    Eigen::Vector3d upper = Eigen::Vector3d::Zero();
    double radius = 0;
    std::vector<std::uint32_t> vertices; // from 0, as the file counts
};

struct Motion {
    enum class Kind { move, turn };
    Kind kind = Kind::move;
    Eigen::Vector3d by = Eigen::Vector3d::Zero(); // of a move
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    double degrees = 0;
};

struct ScriptLine {
    std::size_t number = 0; // in the file, from 1
    Region region;
    std::vector<Motion> motions; // none: hold
};

struct Script {
    std::string path;
    std::vector<ScriptLine> lines;

    std::string where(const ScriptLine& line) const { return path + ":" + std::to_string(line.number); }
};

// Reads a script. Everything wrong with it is added to `findings`, with file, line and remedy; such lines are left out.
Script read_script(const std::string& path, FindingList& findings);

// A complaint of this program: samples have no numbers of their own.
Finding complaint(std::string where, std::string what, std::string hint);

} // namespace pliant
