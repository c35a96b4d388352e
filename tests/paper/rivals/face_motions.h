// How the triangles of each pose are moved from pose 0: what gradient-domain blends are made of.
#pragma once

#include "elastic/average/cells.h"
#include "elastic/energy/energy.h"

#include <vector>

namespace pliant {

// gradient = rotation * stretch.
struct FaceMotion {
    Eigen::Matrix3d rotation, stretch;
};

// Of all triangles from pose 0 to a shape. The third direction is the normal, scaled as the root of the area.
std::vector<FaceMotion> face_motions(const NormalizedPoses& set, const Shape& shape);

// The rotation vector, at most half a turn long, and the rotation by it: Eigen's logarithm and exponential.
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);

// The motion of each face, blended over the poses: logarithms of rotations, and stretches. motions[k]: those of pose k.
std::vector<FaceMotion> blend_motions(const std::vector<std::vector<FaceMotion>>& motions, const Weights& w);

// The shape whose triangles come nearest to those of pose 0 after `motions`, in least squares; its connected parts have the
// centroids of the linear blend.
Shape put_together(const NormalizedPoses& set, const CellFit& fit, const Weights& w, const std::vector<FaceMotion>& motions);

} // namespace pliant
