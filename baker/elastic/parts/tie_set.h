// The ties that hold a character of several parts together. Each tied vertex keeps its place relative to three anchors,
// vertices of another part. baker/THEORY.md, "Ties", has the derivation.
#pragma once

#include "elastic/parts/part_tree.h"

namespace pliant {

// Measures the place of vertices[0] relative to the anchors a, b, c = vertices[1..3] in a frame that rotates with them:
//     e1 = f00 (b - a),  e2 = f01 (b - a) + f11 (c - a),  n = e1 x e2,  r = x - a,  place = (r.e1, r.e2, r.n).
// In the mean metric of the poses e1 and e2 are orthonormal, so that the three coordinates are lengths.
struct Tie {
    std::array<std::uint32_t, 4> vertices;
    Eigen::Matrix2d frame; // f, upper triangular
    double stiffness;      // energy per squared length
    Eigen::Matrix3Xd rest; // the place in every pose, 3 x m
    std::size_t part;      // the part of the tied vertex
};

// A term of the energy: stiffness |place - rest|^2, with the place computed from r, e1, e2 as for a tie. Row i of `factors`
// combines the vertices linearly into r, e1 or e2.
struct PenaltyTerm {
    std::vector<std::uint32_t> vertices;
    Eigen::Matrix3Xd factors; // 3 x vertices; every row sums to 0, so that translations cost nothing
    double stiffness;         // energy per squared length
    Eigen::Matrix3Xd rest;    // the place in every pose, 3 x m
    std::size_t part;
};

// An alternative to the ties of a rigid part that rotates far (elastic/parts/joints.h). Replaces the ties first_tie ...
// first_tie + tie_count - 1 if it is used.
struct Joint {
    std::size_t first_tie, tie_count;
    std::vector<PenaltyTerm> terms;
    bool is_used = false;
};

struct TieSet {
    Parts parts;
    PartTree tree;
    std::vector<Tie> ties;         // grouped by part, then the seams
    std::vector<double> distances; // from each part to its parent, normalized length; 0 for the root
    std::vector<Joint> joints;     // in the order of their ties
    std::size_t seam_count = 0;    // the last ties hold seams (elastic/parts/seams.h)
};

// Largest and smallest stiffness of a tie. The unit is the stiffness with which a membrane of modulus 1 holds one of its
// vertices.
constexpr double max_stiffness = 0.3, min_stiffness = 0.01;

// Stiffness for a place with these values in the poses (3 x m, normalized lengths). The more they differ between the poses,
// the softer: a tie pulls to their mean, and for an eye that rotates the mean is off the arc, so that a stiff tie would dent
// it.
double tie_stiffness(const Eigen::Matrix3Xd& rest, double diagonal);

// Ties vertices[0], a vertex of `part`, to the anchors vertices[1..3].
Tie make_tie(const NormalizedPoses& set, std::size_t part, const std::array<std::uint32_t, 4>& vertices);

// The energy term of a tie.
PenaltyTerm penalty_term_of(const Tie& tie);

// The columns r, e1, e2 of a tie for these positions.
Eigen::Matrix3d tie_vectors(const Tie& tie, const Eigen::Vector3d& vertex, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// The place (r.e1, r.e2, r.n) for the columns r, e1, e2.
Eigen::Vector3d tie_place(const Eigen::Matrix3d& vectors);

// The joint that can replace the ties that start at `first_tie`, or null. The pointer lives as long as the set is unchanged.
const Joint* joint_of(const TieSet& ties, std::size_t first_tie);

// One past the last of the consecutive ties, from `first` on, of the same part.
std::size_t end_of_part(const TieSet& ties, std::size_t first);

} // namespace pliant
