// Moves the handles of a solid to their targets in steps; after each step the free vertices minimize the elastic energy.
#pragma once

#include "elastic/energy/solid.h"
#include "elastic/pose/handles.h"

#include <functional>

namespace pliant {

// One accepted step.
struct DragStep {
    double time = 0;         // fraction of the motion that is done
    double start_energy = 0; // at the start of Newton's method, in units of Young's modulus times the volume of the body
    double energy = 0;
    double last_energy = 0; // of the step before
    double smallest_j = 0;  // of all tetrahedra: volume over volume at rest
    double snap = 0;        // if the body snapped over to another equilibrium: the way of its farthest vertex, input units
    int iterations = 0;
    int halvings = 0; // number of times the step was too long
};

struct DragResult {
    Positions positions; // input units, order of the file; those of the handles are Handles::at(1) to the bit
    DragStep last;
    int steps = 0;
    int iterations = 0;
};

// Called after every step.
using DragReport = std::function<void(const DragStep&)>;

// `rest`: to_shape_set() of the rest pose, with handles.vertices() as its fixed vertices. Throws Failure (failed, P4304) if
// no step is short enough to keep every tetrahedron from turning over. Cost: a factorisation per step and per Newton
// iteration.
DragResult drag(const NormalizedPoses& rest, const Handles& handles, const SolidOptions& material,
                const DragReport& report = {});

// The smallest ratio of a tetrahedron's volume to its volume at rest, and the tetrahedron.
struct SmallestJ {
    double value = 0;
    std::size_t tet = 0;
};
SmallestJ smallest_j(const NormalizedPoses& rest, const Shape& y);

} // namespace pliant
