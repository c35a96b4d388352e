// How well a blend keeps what the poses have, without a reference: by its lengths, its volume, its triangles.
#pragma once

#include "base/mesh/normalized_poses.h"
#include "elastic/energy/energy.h"

#include <array>
#include <vector>

namespace pliant {

struct BlendQuality {
    double strain = 0;         // edges against the weighted mean of their lengths, relative: root mean square by length
    double volume = 0;         // against the weighted mean of the volumes, relative, signed; not a number of open surfaces
    double limb_length = 0;    // largest relative error of the length of a path between landmarks
    double worst_triangle = 0; // least area over the least area of that triangle in any pose
};

// Landmarks: vertices far apart, found by walking from the farthest to the farthest along the edges of pose 0 (Dijkstra).
// Paths: the shortest between each two of them in pose 0, followed in every shape.
class QualityMeter {
public:
    explicit QualityMeter(const NormalizedPoses& set);
    BlendQuality measure(const Weights& w, const Shape& blend) const;

private:
    using Path = std::vector<std::uint32_t>;
    const NormalizedPoses& set_;
    std::vector<std::array<std::uint32_t, 2>> edges_;
    std::vector<Path> limbs_;
    bool is_closed_;
};

} // namespace pliant
