// Other ways to blend poses, unreduced and as plain as their papers allow, to be compared with elastic averages.
#pragma once

#include "base/mesh/normalized_poses.h"
#include "elastic/energy/energy.h"

#include <memory>

namespace pliant {

// What a table says about a rival beside its figures.
struct RivalTraits {
    const char* name;
    const char* source;
    bool takes_many = true;    // more than two poses
    bool is_order_free = true; // no pose is the first
    const char* fails = "";    // where it goes wrong
};

// One way to blend the poses of a set, which outlives it. What does not depend on weights is done when it is made.
class Rival {
public:
    virtual ~Rival() = default;
    virtual const RivalTraits& traits() const = 0;

    // The blend for weights of sum 1. Its place and orientation mean nothing.
    virtual Shape blend(const Weights& w) = 0;
};

// The sum of the aligned poses: morph targets.
std::unique_ptr<Rival> make_linear(const NormalizedPoses& set);

// Gradient domain (Sumner and Popovic 2004; Xu, Zhang, Wang, Bao 2005; Sumner et al. 2005): the deformation gradient of each
// triangle from pose 0 as rotation and stretch, logarithms of rotations and stretches blended, triangles put together by a
// Poisson system whose factor serves all blends.
std::unique_ptr<Rival> make_gradient_domain(const NormalizedPoses& set);

// Differential coordinates with interpolated rotations (Kircher and Garland 2008; Lipman et al. 2005): the rotation from
// each triangle's frame to its neighbours' is blended, frames follow by a least-squares system of its own for every blend,
// then positions by the Poisson system. Frames do not know how far the body has turned from pose 0.
std::unique_ptr<Rival> make_connection_maps(const NormalizedPoses& set);

// Edge lengths and dihedral angles (Winkler, Drieseberg, Alexa, Hormann 2010; Froehlich and Botsch 2011): both are blended
// linearly, and the shape that comes nearest is found by Gauss-Newton steps from the pose of the largest weight.
std::unique_ptr<Rival> make_lengths_and_angles(const NormalizedPoses& set);

} // namespace pliant
