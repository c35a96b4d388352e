// A shape as the rotation and the strain of its cells against a base.
#pragma once

#include "elastic/average/cells.h"

#include <vector>

namespace pliant {

// Coordinates in which elastic averages are nearly linear in the weights (Huang, Tong, Zhou, Bao, Desbrun 2011): for each
// cell the rotation vector and the strain of the map that takes it from the base to the shape (polar decomposition), and the
// centroid of each connected component. Half of the coordinates of a limb that turned are a limb that turned half as far.
// Rotation vectors are continuous over the body: they may be longer than half a turn. Tasks may use one at the same time.
class RotationStrain {
public:
    // The set must outlive it.
    RotationStrain(const NormalizedPoses& set, Shape base);

    // Cost: linear in the cells.
    Eigen::VectorXd coordinates(const Shape& shape) const;

    // How the coordinates change along displacements of the shape (columns).
    Eigen::MatrixXd derivatives(const Shape& shape, const Eigen::VectorXd& coordinates,
                                const Eigen::MatrixXd& displacements) const;

    // The coordinates as fields of the body, for meshes of other cells. A column per vertex: the rotation vector and the
    // strain, a symmetric matrix in the axes of space (xx xy xz yy yz zz), both means over the cells around it, and the
    // centroid of its component. Surfaces only.
    Eigen::MatrixXd at_vertices(const Eigen::VectorXd& coordinates) const;

    // Adds to the coordinates of every cell the means of such fields over its corners.
    void add_at_vertices(const Eigen::MatrixXd& fields, Eigen::VectorXd& coordinates) const;

    // The shape whose cells come nearest to these coordinates, aligned to pose 0. Coordinates of a shape give the shape.
    Shape shape(const Eigen::VectorXd& coordinates, const CellFit& fit) const;

private:
    Eigen::VectorXd principal(const Shape& shape) const;
    void make_continuous(Eigen::VectorXd& coordinates) const;
    Eigen::Matrix3Xd centroids(const Shape& shape) const;
    Eigen::Index cell_size() const { return set_.is_solid() ? 9 : 6; } // coordinates of a cell
    Eigen::Index cell_count() const { return Eigen::Index(neighbours_.size()); }
    Eigen::Index centroid_row(std::uint32_t component) const { return cell_size() * cell_count() + 3 * component; }

    const NormalizedPoses& set_;
    Shape base_;
    std::vector<std::vector<std::uint32_t>> neighbours_; // cells that share an edge (triangles) or a face (tetrahedra)
    std::vector<std::uint32_t> component_of_vertex_;     // parts that touch in a vertex are one component
    std::vector<bool> is_held_;                          // components with fixed vertices
};

} // namespace pliant
