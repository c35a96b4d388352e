// Where an average lies, which no elastic energy says.
#pragma once

#include "base/mesh/normalized_poses.h"

namespace pliant {

// Averages of poses that were aligned to pose 0 are aligned to it as well. Poses, or layers, that stay where they are
// (NormalizedPoses::frame) move a character as morph targets do: an average lies where its affine part is closest to that of
// the linear blend. The affine part is the map of the frame that comes closest to a shape; the surrogate energy can hold it
// (Gauge). The place depends continuously on the weights, and at a pose it is the pose's own. A held body lies where it is.
class Placement {
public:
    // `set` must outlive it.
    explicit Placement(const NormalizedPoses& set);

    bool is_kept() const { return functions_.cols() > 0; }

    // Moves the shape rigidly to its place at w.
    void place(const Weights& w, Shape& shape) const;

    // Adds rigid motions of `shape`, which lies at its place at w, to displacements (3n x c) that come with a change of the
    // weights along directions (m x c, of averages), so that to first order it stays at its place.
    void keep(const Weights& w, const Eigen::MatrixXd& directions, const Shape& shape, Eigen::MatrixXd& displacements) const;

    // The affine parts of shapes or displacements (3n x c): for each affine function of the frame, orthonormal in the mass
    // inner product, three coefficients (12 x c; of a flat frame 9 x c). Only if poses are kept.
    Eigen::MatrixXd affine_part(const Eigen::MatrixXd& columns) const;

private:
    const NormalizedPoses& set_;
    Eigen::MatrixXd flattened(const Eigen::MatrixXd& columns) const; // the affine parts, as shapes
    Eigen::MatrixXd functions_;                                      // affine functions of the frame (n x 3 or 4)
};

} // namespace pliant
