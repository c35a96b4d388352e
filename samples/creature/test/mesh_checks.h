// Measurements of a set of poses.
#pragma once

#include "../types.h"

namespace pliant::creature {

// Connectivity alone.
struct TopologyReport {
    bool closed_manifold = false; // every edge has two faces of opposite direction, every vertex one fan
    bool all_vertices_used = false;
    int components = 0;
    int euler_characteristic = 0;
};
TopologyReport check_topology(int vertex_count, const std::vector<Face>& faces);

// One pose. Angles in degrees, dihedral angles (0: flat) in radians.
struct ShapeReport {
    bool finite = false;
    int coincident_vertices = 0; // vertices at the float32 position of another one
    double smallest_angle = 0.0;
    double edge_ratio = 0.0; // longest edge over shortest
    double largest_dihedral = 0.0;
    double volume = 0.0;                       // positive: faces look outwards
    std::vector<std::array<int, 2>> crossings; // edges that pierce faces: one vertex of the edge, one of the face
};
ShapeReport check_shape(const std::vector<Vec3>& points, const std::vector<Face>& faces);

// The change of edge lengths between two poses.
struct StretchReport {
    double share_outside = 0.0;     // of edges whose length ratio lies outside [0.6, 1.7]
    double least = 0.0, most = 0.0; // ratio
};
StretchReport check_stretch(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const std::vector<Face>& faces);

} // namespace pliant::creature
