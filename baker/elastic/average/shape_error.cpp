#include "elastic/average/shape_error.h"

#include "elastic/average/rigid_modes.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

// Moved rigidly onto the blend.
Shape aligned_reference(const NormalizedPoses& set, const Shape& blend, Shape reference)
{
    align_to(set, blend, reference);
    return reference;
}

// The same, but where shapes have places of their own, which count.
Shape placed_reference(const NormalizedPoses& set, const Shape& blend, const Shape& reference)
{
    return set.frame.size() > 0 ? reference : aligned_reference(set, blend, reference);
}

// Mass norm of a shape about its centroid.
double extent(const NormalizedPoses& set, const Shape& shape)
{
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (Eigen::Index v = 0; v < set.masses.size(); ++v) centroid += set.masses[v] * shape.segment<3>(3 * v);
    centroid /= set.masses.sum();
    double sum = 0;
    for (Eigen::Index v = 0; v < set.masses.size(); ++v)
        sum += set.masses[v] * (shape.segment<3>(3 * v) - centroid).squaredNorm();
    return std::sqrt(sum);
}

} // namespace

ShapeError shape_distance(const NormalizedPoses& set, const Shape& blend, const Shape& reference)
{
    const Shape placed = placed_reference(set, blend, reference), off = placed - blend;
    ShapeError error;
    error.relative_l2 = mass_norm(off, set.masses) / extent(set, placed);
    for (Eigen::Index v = 0; v < set.masses.size(); ++v)
        error.largest_distance = std::max(error.largest_distance, off.segment<3>(3 * v).norm() / set.diagonal);
    return error;
}

ShapeError shape_error(const Energy& energy, const NormalizedPoses& set, const Weights& w, const Shape& blend,
                       const Shape& reference)
{
    ShapeError error = shape_distance(set, blend, reference);
    error.energy_excess = std::nan("");
    if (energy.blend() == Blend::layers) return error; // where they fit together, there is no energy to compare with
    const double least = energy_value(energy, w, reference);
    error.energy_excess = (energy_value(energy, w, blend) - least) / std::max(least, 1e-13); // a pose itself has no energy
    return error;
}

double relative_error(const NormalizedPoses& set, const Shape& blend, const Shape& reference)
{
    const Shape placed = placed_reference(set, blend, reference);
    return mass_norm(placed - blend, set.masses) / extent(set, placed);
}

double relative_move(const NormalizedPoses& set, const Shape& from, const Shape& to)
{
    return mass_norm(to - from, set.masses) / extent(set, from);
}

double relative_distance(const NormalizedPoses& set, const Shape& blend, const Shape& reference)
{
    const Shape aligned = aligned_reference(set, blend, reference);
    return mass_norm(aligned - blend, set.masses) / extent(set, aligned);
}

} // namespace pliant
