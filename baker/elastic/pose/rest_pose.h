// The rest pose of a solid, read and checked as `pliant check` does.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/align.h"

#include <optional>

namespace pliant {

struct RestPose {
    MeshFile mesh;                    // its tetrahedra have positive volumes
    std::vector<Tetrahedron> as_read; // corners in the order of the file, for writing
    std::vector<Triangle> boundary;
};

// Adds all errors and warnings about the file to `findings` (P2001 to P2218, P2609). Empty if no solid could be read.
std::optional<RestPose> read_rest_pose(const std::string& path, FindingList& findings);

// The rest pose in the units of the solver, with these vertices fixed.
ShapeSet to_shape_set(const RestPose& rest, const std::vector<std::uint32_t>& fixed);

// The boundary of a deformed state as a PLY file in memory.
std::string encode_boundary(const RestPose& rest, const Positions& positions);

} // namespace pliant
