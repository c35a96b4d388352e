// Vertices that stay where they are in every blend.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"

namespace pliant {

// Reads vertex numbers from a text file: one a line, from 0, as the pose files count; # begins a comment. Result: ascending,
// each once. Errors: P2001, P2002, P2008 the file, P2602 not a number, P2603 out of range.
std::vector<std::uint32_t> read_fixed_vertices(const std::string& path, std::size_t vertex_count,
                                               DiagnosticList& diagnostics);

// Can these be fixed in these poses, of which `vertex_count` vertices move on their own? Errors: P2604 too few to hold the
// body, P2605 all of them, P3013 other places in other poses.
void check_fixed_vertices(const std::string& path, const std::vector<std::uint32_t>& fixed, std::size_t vertex_count,
                          const std::vector<MeshFile>& meshes, DiagnosticList& diagnostics);

// Fixed vertices of all poses exactly where the first pose has them.
void pin_vertices(const std::vector<std::uint32_t>& fixed, std::vector<Positions>& poses);

} // namespace pliant
