// The script of `pliant pose`: plain text, one handle per line: a region of vertices and its motion.
//     box    x0 y0 z0 x1 y1 z1    MOTION...
//     sphere x y z r              MOTION...
//     vertices i j k ...          MOTION...
// where MOTION is one of the following; several are applied in order:
//     hold | move dx dy dz | turn px py pz ax ay az degrees
// Points are fractions of the bounding box of the rest pose (0 0 0 its lower corner, 1 1 1 its upper one); lengths
// (r, dx dy dz) are fractions of its diagonal. So a script does not depend on the unit of the mesh. Axes are those of the
// file, angles are in degrees. # starts a comment.
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

// Reads a script. Leaves out bad lines and adds an error with file and line for each to `diagnostics` (P2801 to P2811;
// P2001, P2002, P2008 if the file cannot be read).
Script read_script(const std::string& path, DiagnosticList& diagnostics);

} // namespace pliant
