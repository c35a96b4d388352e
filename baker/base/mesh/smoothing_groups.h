// Which drawn vertices share a normal: what the chunk SMTH of an asset says.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace pliant {

// One number per drawn vertex: the lowest vertex of its group. Vertices share a normal if they were welded to one (`welded`:
// drawn vertex to welded vertex, any numbers) and their input normals differ by at most 1 degree; without input normals
// (`normals` empty) all that were welded do. A normal without length agrees with every other: its file did not know it.
// `sides`, if not empty: what the normals of each vertex's own triangles add up to; the two sides of a sheet, more than 177
// degrees apart, do not share a normal, which would be none.
// Vertices are taken in order, and each joins the first group of less than 256 whose first vertex it agrees with. Throws
// std::invalid_argument if there are normals or sides, but not one for each vertex. Cost: linear, times the groups at one
// place.
std::vector<std::uint32_t> smoothing_groups(const std::vector<std::uint32_t>& welded,
                                            const std::vector<Eigen::Vector3d>& normals = {},
                                            const std::vector<Eigen::Vector3d>& sides = {});

// Whether every vertex is a group of its own: then an asset needs no SMTH.
bool is_trivial(const std::vector<std::uint32_t>& groups);

} // namespace pliant
