// What the baker works on: several poses of one triangle mesh. Plain data, no behaviour.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pliant {

// n x 3, one row per vertex, in the units of the file it came from.
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangle = std::array<std::uint32_t, 3>;

// Faces as a file gave them: face f has corners indices[offsets[f]] .. indices[offsets[f + 1] - 1].
struct Polygons {
    std::vector<std::uint32_t> offsets = { 0 };
    std::vector<std::uint32_t> indices;

    std::size_t count() const { return offsets.size() - 1; }
    std::size_t size(std::size_t face) const { return offsets[face + 1] - offsets[face]; }
};

// One mesh file, read but not yet compared with others.
struct MeshFile {
    std::string path;
    Positions positions;
    Polygons faces;
    std::vector<std::uint32_t> face_lines; // line of each face in a text file, empty for binary ones; for messages
};

// Poses of one character: same faces, other positions. Pose 0 is the rest pose of the subspace (tau).
struct PoseSet {
    std::vector<std::string> paths;
    std::vector<std::string> names;   // file names without folder and extension, for people
    std::vector<Positions> positions; // per pose
    Polygons polygons;                // as pose 0 gave them, for writing
    std::vector<Triangle> triangles;  // the same, triangulated alike in all poses: a fan from the first corner

    std::size_t pose_count() const { return positions.size(); }
    std::size_t vertex_count() const { return positions.empty() ? 0 : static_cast<std::size_t>(positions[0].rows()); }
};

} // namespace pliant
