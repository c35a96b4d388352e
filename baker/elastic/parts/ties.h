// What holds a character of several parts together: each tied vertex keeps its place relative to three vertices of another part.
// How they are chosen and why: baker/THEORY.md, "Ties".
#pragma once

#include "elastic/parts/parts.h"

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
struct Pull {
    std::vector<std::uint32_t> vertices;
    Eigen::Matrix3Xd factors; // the sum of each row is 0
    double stiffness;
    Eigen::Matrix3Xd rest; // as in Tie
    std::size_t part;
};

Pull pull_of(const Tie& tie);

// What may hold a rigid part that turns far, in the place of these ties of its (elastic/parts/joints.h).
struct Joint {
    std::size_t first_tie, tie_count;
    std::vector<Pull> pulls;
    bool is_used = false; // and its ties are not
};

// As stiff as a place may be held that is known in every pose, energy per squared length: the less it is the same in all, the softer.
double stiffness_of(const Eigen::Matrix3Xd& rest, double diagonal);

// Columns r, e1, e2.
Eigen::Matrix3d tie_vectors(const Tie& tie, const Eigen::Vector3d& vertex, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c);
Eigen::Vector3d tie_place(const Eigen::Matrix3d& vectors);

// A part for people: a vertex of it, and one of the part that it hangs on.
struct TiePart {
    std::uint32_t vertex, host_vertex;
    std::size_t vertex_count, tie_count;
    double distance; // of the nearest vertex of either from the other (root mean square over the poses), per diagonal
};

struct TieSet {
    Parts parts;
    PartTree tree;
    std::vector<Tie> ties;
    std::vector<double> distances; // per part: to its host, normalised units; 0 for the root
    std::vector<Joint> joints;     // of parts that turn far, in the order of their ties
    std::size_t seam_count = 0;    // the last ties: borders that lie on other borders (T-junctions, cracks)
};

// None for a surface in one part without such borders, and for solids. No joint is used yet. Costs n log n.
TieSet find_ties(const ShapeSet& set);

// The joint in the place of ties that begin at this one; null: there is none.
const Joint* joint_of(const TieSet& ties, std::size_t first_tie);

std::vector<TiePart> describe_parts(const TieSet& ties, const ShapeSet& set);

// The tied vertices of a part in a shape, a column each.
struct PartPlaces {
    std::size_t part, first; // its ties: first, first + 1, ...
    Eigen::Matrix3Xd found, wanted,
        pulled; // where they are, where their anchors would have them, and where they are pulled to
    double drift(std::size_t i) const { return (found.col(Eigen::Index(i)) - wanted.col(Eigen::Index(i))).norm(); }
};

// Wanted is each part's cloud of tied vertices at the mean of its places in the poses, weighted like these, where a part that turns between
// poses turns in step about the point of it that moves least, and does not shrink. (Ties pull to the plain mean.) Parts with seams are there
// twice.
std::vector<PartPlaces> place_parts(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y);

// How far the tied vertices of a shape are from where they are wanted.
struct TieDrift {
    double largest = 0; // over the ties, in units of the diagonal
    std::size_t part = 0;
    std::uint32_t vertex = 0;
};
TieDrift measure_drift(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y);

} // namespace pliant
