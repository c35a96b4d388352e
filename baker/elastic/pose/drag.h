// Drags the handles of a solid to their targets and lets the elastic energy of the rest pose find the rest, step by step.
#pragma once

#include "elastic/energy/solid.h"
#include "elastic/pose/handles.h"

#include <functional>

namespace pliant {

// One step that was taken.
struct DragStep {
    double time = 0;         // part of the motion that is done
    double start_energy = 0; // where Newton's method began, in units of Young's modulus times the volume of the body
    double energy = 0;
    double smallest_j = 0; // of all tetrahedra: volume over that at rest
    int iterations = 0;
    int halvings = 0; // how often the step was too long
};

struct DragResult {
    Positions positions; // input units, order of the file; handles lie exactly at Handles::at(1)
    DragStep last;
    int steps = 0;
    int iterations = 0;
};

// Called behind every step.
using DragReport = std::function<void(const DragStep&)>;

// `rest` is what normalise() makes of the rest pose alone, with handles.vertices() as its fixed vertices. Throws Failure (failed) where
// no step is short enough to keep every tetrahedron from turning over.
DragResult drag(const ShapeSet& rest, const Handles& handles, const SolidOptions& material, const DragReport& report = {});

// The smallest ratio of a tetrahedron's volume to that at rest, and whose it is.
struct SmallestJ {
    double value = 0;
    std::size_t tet = 0;
};
SmallestJ smallest_j(const ShapeSet& rest, const Shape& y);

} // namespace pliant
