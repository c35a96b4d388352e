// From files to a checked set of poses.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"
#include "base/mesh/weld.h"

#include <optional>

namespace pliant {

struct LoadOptions {
    std::optional<Blend> blend; // none: what the files are (read_pose_sources)
    // Averages will be aligned rigidly: poses that differ by a motion only are the same.
    bool align = true;
    // Unless they are of one glTF file and stay where it puts them; found by load_poses().
    bool share_frame = false;
    std::size_t lines_per_number = 10; // diagnostics of one kind that are told one by one
    std::string fixed_path;            // a text file of fixed vertices; then nothing is aligned. Empty: none is fixed
    std::vector<std::uint32_t> fixed_vertices; // the same by the files' numbers; those past the last one are left out
    std::string fixed_name;                    // what messages call fixed_vertices; empty: they are not judged
    // Of surfaces, see base/mesh/weld.h; 0: vertices stay as the files have them
    double weld_tolerance = default_weld_tolerance;
};

// Reads 2 to pose_limit() poses from mesh files and glTF files (input/poses/pose_source.h says what an argument may be) and
// checks that an elastic average of them exists: each file on its own (P2xxx) and against the first (P3xxx). All diagnostics
// of all files are gathered before anything is thrown.
//
// Result of surfaces: positions as they are in the files, vertices in their order; the faces of the first file; their
// triangles. All positions are finite, all triangles have an area in every pose and three vertices that no other one has.
// Vertices that lie on each other in all poses are one, and faces without an elastic energy are left out
// (input/poses/simulation_mesh.h): then `drawn` has all of them. The surface need not be manifold, oriented or connected,
// nor use every vertex: `repairs` counts, warnings tell. Result of solids: see PoseSet for the numbering. All tetrahedra
// have a positive volume in every pose, hang together by their faces, and use every vertex; the boundary is closed and
// counter-clockwise seen from outside, but may touch itself in edges and vertices. Fixed vertices have exactly the same
// positions in all poses. Messages use the numbers of the files. Throws Failure (bad_input) with errors and warnings.
// Without errors, warnings are appended to `warnings` if it is not null. Time and memory: proportional to the size of the
// files, plus sorting the edges.
PoseSet load_poses(const std::vector<std::string>& paths, const LoadOptions& options = {},
                   std::vector<Diagnostic>* warnings = nullptr);

// The same for poses that are in memory: two or more, each as read_mesh leaves it (finite coordinates, indices of vertices
// that there are, faces of three corners or more).
PoseSet check_poses(std::vector<MeshFile> meshes, const LoadOptions& options = {},
                    std::vector<Diagnostic>* warnings = nullptr);

// What people call a pose: its name, else that of its file without folder and extension.
std::string pose_name(const MeshFile& mesh);

} // namespace pliant
