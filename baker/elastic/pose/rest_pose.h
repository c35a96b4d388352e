// The rest pose of a solid, read and checked as the baker does it.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/align.h"

#include <optional>

namespace pliant {

struct RestPose {
    MeshFile mesh;                    // its tetrahedra have positive volumes
    std::vector<Tetrahedron> as_read; // the corners as the file had them: what is written must look like the rest pose
    std::vector<Triangle> boundary;
};

// Everything wrong with the file is added to `findings`; then the result may be empty.
std::optional<RestPose> read_rest_pose(const std::string& path, FindingList& findings);

// The rest pose in the units of the solver, with these vertices fixed.
ShapeSet to_shape_set(const RestPose& rest, const std::vector<std::uint32_t>& fixed);

// The boundary of a deformed state as a PLY file in memory.
std::string encode_boundary(const RestPose& rest, const Positions& positions);

} // namespace pliant
