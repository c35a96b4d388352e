// What holds a character of several parts together: each tied vertex keeps its place relative to three vertices of another part.
// How they are chosen and why: baker/THEORY.md, "Ties".
#pragma once

#include "elastic/parts/part_tree.h"

namespace pliant {

// The place of `vertices[0]` relative to the anchors a b c = vertices[1..3] is measured along three vectors that turn with them,
//     e1 = f00 (b - a),  e2 = f01 (b - a) + f11 (c - a),  n = e1 x e2:   (r.e1, r.e2, r.n),  r = x - a.
// On the mean of the poses e1 and e2 are orthonormal, so that the three numbers are lengths.
struct Tie {
    std::array<std::uint32_t, 4> vertices;
    Eigen::Matrix2d frame; // f, upper triangular
    double stiffness;      // energy per squared length
    Eigen::Matrix3Xd rest; // the three numbers in every pose
    std::size_t part;      // the tied vertex's
};

// A term of the energy: stiffness |place - rest|^2. Row by row, factors times the vertices make r, e1 and e2.
struct PenaltyTerm {
    std::vector<std::uint32_t> vertices;
    Eigen::Matrix3Xd factors; // the sum of each row is 0
    double stiffness;
    Eigen::Matrix3Xd rest; // as in Tie
    std::size_t part;
};

// What may hold a rigid part that rotations far, in the place of these ties of its (elastic/parts/joints.h).
struct Joint {
    std::size_t first_tie, tie_count;
    std::vector<PenaltyTerm> terms;
    bool is_used = false; // and its ties are not
};

struct TieSet {
    Parts parts;
    PartTree tree;
    std::vector<Tie> ties;
    std::vector<double> distances; // per part: to its parent, normalised units; 0 for the root
    std::vector<Joint> joints;     // of parts that turn far, in the order of their ties
    std::size_t seam_count = 0;    // the last ties: borders that lie on other borders (T-junctions, cracks)
};

// A tie of a vertex of `part` to three anchors; the first of `vertices` is the tied one.
Tie make_tie(const ShapeSet& set, std::size_t part, const std::array<std::uint32_t, 4>& vertices);

PenaltyTerm penalty_term_of(const Tie& tie);

// As stiff as a membrane of modulus 1 is to one of its vertices, times this, for a tie whose place hardly differs between the poses.
// Where places differ by more than this (units of the diagonal), the mean of the places means less, down to the least stiffness: an eye
// that rotations would get dents from ties that pull its vertices from the arc to the chord. THEORY.md tells what other values do.
constexpr double max_stiffness = 0.3, min_stiffness = 0.01, sure_place = 0.005;

// As stiff as a place may be held that is known in every pose, energy per squared length: the less it is the same in all, the softer.
double tie_stiffness(const Eigen::Matrix3Xd& rest, double diagonal);

// Columns r, e1, e2.
Eigen::Matrix3d tie_vectors(const Tie& tie, const Eigen::Vector3d& vertex, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c);
Eigen::Vector3d tie_place(const Eigen::Matrix3d& vectors);

// The joint in the place of ties that begin at this one; null: there is none.
const Joint* joint_of(const TieSet& ties, std::size_t first_tie);

// The end of the ties of a part that begin at `first`.
std::size_t end_of_part(const TieSet& ties, std::size_t first);

} // namespace pliant
