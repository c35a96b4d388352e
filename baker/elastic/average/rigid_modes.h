// The six rigid motions of a free body, which no elastic energy sees.
#pragma once

#include "base/mesh/surface.h"

namespace pliant {

// Infinitesimal translations and rotations of y about its centroid, orthonormal in the mass inner product (3n x 6).
Eigen::MatrixXd rigid_modes(const Shape& y, const Eigen::VectorXd& masses);

// Mass inner product of shapes; masses per vertex.
double mass_dot(const Shape& a, const Shape& b, const Eigen::VectorXd& masses);
double mass_norm(const Shape& a, const Eigen::VectorXd& masses);
Eigen::MatrixXd times_mass(const Eigen::MatrixXd& vectors, const Eigen::VectorXd& masses);

// Removes the rigid part from displacements (columns): x - R R^T M x.
void remove_rigid_motion(Eigen::Ref<Eigen::MatrixXd> displacements, const Eigen::MatrixXd& modes,
                         const Eigen::VectorXd& masses);

// Makes loads (columns) orthogonal to the rigid modes, so that they do no work on them: f - M R R^T f.
void balance_load(Eigen::Ref<Eigen::MatrixXd> loads, const Eigen::MatrixXd& modes, const Eigen::VectorXd& masses);

// Six degrees of freedom whose pinning removes exactly the rigid motions: three coordinates of one vertex, two of a second
// and one of a third, the vertices far apart, the coordinates chosen for the best-conditioned choice.
std::vector<Eigen::Index> statically_determinate_pins(const Shape& y);

} // namespace pliant
