// How the triangles of a simulation mesh hang together.
#pragma once

#include "input/poses/simulation_mesh.h"

namespace pliant {

// Checks and counts how the triangles hang together, positions unseen; `first` names file and lines. Warnings, for none of
// this keeps discrete shells from working: P2203 edges of three or more faces, P2204 neighbours of opposite orientation,
// P2206 bow-tie vertices, P2207 vertices without a triangle, P2208 several components (parts that touch in single vertices
// only can turn there freely, so they count as several).
void check_connectivity(const MeshFile& first, SimulationMesh& surface, DiagnosticList& diagnostics);

} // namespace pliant
