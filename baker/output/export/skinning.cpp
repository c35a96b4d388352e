#include "output/export/skinning.h"

#include "reduced/surrogate/nnls.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

namespace {

constexpr int cluster_rounds = 4;   // between two splits: assignments hardly change after that
constexpr int alternations = 12;    // bones and weights in turn: the paper's figures level off at ten
constexpr int sweeps_per_round = 2; // over the bones, which see each other's last place
constexpr int sweeps_alone = 12;    // where the weights stay
constexpr std::size_t candidate_count
    = 8; // bones that a vertex may choose its influences from: those that move most like it

// A vertex' share in a bone below which it says nothing about where the bone is.
constexpr double least_mass = 1e-9;

// The proper rotation nearest to the transpose of the covariance sum a b^T: takes the a to the b.
Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& covariance)
{
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
    return svd.matrixV() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixU().transpose();
}

// min over R, T of sum_i |m_i (R p_i + T) - q_i|^2, from its sums.
struct BoneSums {
    double mass = 0;                                   // sum m^2
    Eigen::Vector3d rest = Eigen::Vector3d::Zero();    // sum m^2 p
    Eigen::Vector3d target = Eigen::Vector3d::Zero();  // sum m q
    Eigen::Matrix3d product = Eigen::Matrix3d::Zero(); // sum m p q^T

    void add(double m, const Eigen::Vector3d& p, const Eigen::Vector3d& q)
    {
        mass += m * m;
        rest += m * m * p;
        target += m * q;
        product += m * p * q.transpose();
    }
    BoneMotion solve(const BoneMotion& otherwise) const
    {
        if (mass < least_mass) return otherwise;
        const Eigen::Vector3d p = rest / mass, q = target / mass;
        BoneMotion motion;
        motion.rotation = rotation_of(product - mass * p * q.transpose());
        motion.translation = q - motion.rotation * p;
        return motion;
    }
};

// ------------------------------------------------------------------------------------------------------------ clusters --

struct Clusters {
    const Eigen::Matrix3Xd& rest;
    const std::vector<Eigen::Matrix3Xd>& shapes;
    std::vector<std::size_t> of_vertex;
    std::vector<BonePose> poses; // per shape

    std::size_t count() const { return poses[0].size(); }

    double error(Eigen::Index v, std::size_t cluster) const
    {
        double sum = 0;
        for (std::size_t s = 0; s < shapes.size(); ++s)
            sum += (poses[s][cluster] * rest.col(v) - shapes[s].col(v)).squaredNorm();
        return sum;
    }
    void move_bones()
    {
        for (std::size_t s = 0; s < shapes.size(); ++s) {
            std::vector<BoneSums> sums(count());
            for (Eigen::Index v = 0; v < rest.cols(); ++v)
                sums[of_vertex[std::size_t(v)]].add(1, rest.col(v), shapes[s].col(v));
            for (std::size_t b = 0; b < count(); ++b) poses[s][b] = sums[b].solve(poses[s][b]);
        }
    }
    void assign()
    {
        for (Eigen::Index v = 0; v < rest.cols(); ++v) {
            std::size_t best = 0;
            double least = error(v, 0);
            for (std::size_t b = 1; b < count(); ++b) {
                const double e = error(v, b);
                if (e < least) least = e, best = b;
            }
            of_vertex[std::size_t(v)] = best;
        }
    }
    // The cluster with the largest error gives the half farther from its centre, on the side of its worst vertex, to a new
    // one.
    bool split()
    {
        std::vector<double> errors(count());
        std::vector<Eigen::Index> worst(count(), -1);
        std::vector<double> worst_error(count(), -1);
        for (Eigen::Index v = 0; v < rest.cols(); ++v) {
            const std::size_t b = of_vertex[std::size_t(v)];
            const double e = error(v, b);
            errors[b] += e;
            if (e > worst_error[b]) worst_error[b] = e, worst[b] = v;
        }
        const std::size_t chosen = std::size_t(std::max_element(errors.begin(), errors.end()) - errors.begin());
        if (!(errors[chosen] > 0)) return false;
        std::vector<std::pair<double, Eigen::Index>> members;
        for (Eigen::Index v = 0; v < rest.cols(); ++v)
            if (of_vertex[std::size_t(v)] == chosen)
                members.emplace_back((rest.col(v) - rest.col(worst[chosen])).squaredNorm(), v);
        if (members.size() < 8) return false; // two bones of four vertices: they have a rotation yet
        std::sort(members.begin(), members.end());
        for (std::size_t i = 0; i < members.size() / 2; ++i) of_vertex[std::size_t(members[i].second)] = count();
        for (BonePose& pose : poses) pose.push_back(pose[chosen]);
        return true;
    }
};

std::vector<BonePose> cluster_bones(const Eigen::Matrix3Xd& rest, const std::vector<Eigen::Matrix3Xd>& shapes,
                                    std::size_t bone_count)
{
    Clusters clusters { rest, shapes, std::vector<std::size_t>(std::size_t(rest.cols()), 0),
                        std::vector<BonePose>(shapes.size(), BonePose(1)) };
    clusters.move_bones();
    while (clusters.count() < bone_count && clusters.split()) {
        for (int round = 0; round < cluster_rounds; ++round) {
            clusters.move_bones();
            clusters.assign();
        }
    }
    clusters.move_bones();
    return clusters.poses;
}

// ------------------------------------------------------------------------------------------------------------- weights --

// Convex weights of the given bones that bring the vertex closest to its places; nnls with the sum as an equation of great
// weight.
Eigen::VectorXd convex_weights(const Eigen::MatrixXd& places, const Eigen::VectorXd& target)
{
    Eigen::MatrixXd gram = places.transpose() * places;
    Eigen::VectorXd right = places.transpose() * target;
    // A thousand times the largest of what is fitted: the sum is 1 to a thousandth, and then exactly, by division.
    const double heavy = 1e3 * (gram.diagonal().maxCoeff() + 1e-300);
    gram.array() += heavy;
    right.array() += heavy;
    Eigen::VectorXd w = nnls(gram, right);
    const double sum = w.sum();
    if (!(sum > 0) || !std::isfinite(sum)) return Eigen::VectorXd::Unit(w.size(), 0);
    return w / sum;
}

Influences fit_influences(Eigen::Index v, const Eigen::Matrix3Xd& rest, const std::vector<Eigen::Matrix3Xd>& shapes,
                          const std::vector<BonePose>& poses)
{
    const std::size_t bone_count = poses[0].size();
    const Eigen::Index rows = 3 * Eigen::Index(shapes.size());
    // Relative to the target: numbers as large as what is to be told apart, not as the character is far from the origin.
    Eigen::MatrixXd places(rows, Eigen::Index(bone_count));
    for (std::size_t s = 0; s < shapes.size(); ++s)
        for (std::size_t b = 0; b < bone_count; ++b)
            places.block<3, 1>(3 * Eigen::Index(s), Eigen::Index(b)) = poses[s][b] * rest.col(v) - shapes[s].col(v);
    std::vector<Eigen::Index> bones(bone_count);
    std::iota(bones.begin(), bones.end(), 0);
    const Eigen::VectorXd errors = places.colwise().squaredNorm();
    std::stable_sort(bones.begin(), bones.end(), [&](Eigen::Index a, Eigen::Index b) { return errors[a] < errors[b]; });
    bones.resize(std::min(bone_count, candidate_count));
    const auto columns = [&] {
        Eigen::MatrixXd chosen(rows, Eigen::Index(bones.size()));
        for (std::size_t i = 0; i < bones.size(); ++i) chosen.col(Eigen::Index(i)) = places.col(bones[i]);
        return chosen;
    };
    const Eigen::VectorXd target = Eigen::VectorXd::Zero(rows);
    Eigen::VectorXd weights = convex_weights(columns(), target);
    if (bones.size() > max_influences) {
        std::vector<std::size_t> order(bones.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return weights[Eigen::Index(a)] > weights[Eigen::Index(b)]; });
        std::vector<Eigen::Index> kept;
        for (std::size_t i = 0; i < max_influences; ++i) kept.push_back(bones[order[i]]);
        bones = kept;
        weights = convex_weights(columns(), target);
    }
    Influences result;
    for (std::size_t i = 0; i < bones.size(); ++i) {
        result.weights[i] = weights[Eigen::Index(i)];
        if (result.weights[i] > 0) result.bones[i] = std::uint16_t(bones[i]); // glTF wants bone 0 where the weight is 0
    }
    return result;
}

// --------------------------------------------------------------------------------------------------------------- bones --

// What each bone moves, so that a sweep costs as much as there are influences.
struct Member {
    Eigen::Index vertex;
    double weight;
};

std::vector<std::vector<Member>> members_of(const Skin& skin)
{
    std::vector<std::vector<Member>> members(skin.bone_count);
    for (std::size_t v = 0; v < skin.influences.size(); ++v)
        for (std::size_t i = 0; i < max_influences; ++i)
            if (skin.influences[v].weights[i] > 0)
                members[skin.influences[v].bones[i]].push_back({ Eigen::Index(v), skin.influences[v].weights[i] });
    return members;
}

// Each bone in turn goes where it is best while the others stay.
void sweep_bones(const Skin& skin, const std::vector<std::vector<Member>>& members, const Eigen::Matrix3Xd& shape,
                 BonePose& pose, int sweeps)
{
    Eigen::Matrix3Xd residual = shape - skin.shape(pose);
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (std::size_t b = 0; b < skin.bone_count; ++b) {
            BoneSums sums;
            const BoneMotion old = pose[b];
            for (const Member& m : members[b])
                sums.add(m.weight, skin.rest.col(m.vertex),
                         residual.col(m.vertex) + m.weight * (old * skin.rest.col(m.vertex)));
            pose[b] = sums.solve(old);
            for (const Member& m : members[b])
                residual.col(m.vertex) += m.weight * (old * skin.rest.col(m.vertex) - pose[b] * skin.rest.col(m.vertex));
        }
}

} // namespace

Eigen::Matrix3Xd Skin::shape(const BonePose& pose) const
{
    Eigen::Matrix3Xd out = Eigen::Matrix3Xd::Zero(3, rest.cols());
    for (Eigen::Index v = 0; v < rest.cols(); ++v) {
        const Influences& influence = influences[std::size_t(v)];
        for (std::size_t i = 0; i < max_influences; ++i)
            if (influence.weights[i] > 0) out.col(v) += influence.weights[i] * (pose[influence.bones[i]] * rest.col(v));
    }
    return out;
}

Eigen::Vector3d Skin::centre(std::size_t bone) const
{
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double mass = 0;
    for (std::size_t v = 0; v < influences.size(); ++v)
        for (std::size_t i = 0; i < max_influences; ++i)
            if (influences[v].bones[i] == bone) {
                sum += influences[v].weights[i] * rest.col(Eigen::Index(v));
                mass += influences[v].weights[i];
            }
    return mass > 0 ? (sum / mass).eval() : rest.rowwise().mean().eval();
}

SkinFit fit_skin(const Eigen::Matrix3Xd& rest, const std::vector<Eigen::Matrix3Xd>& shapes, std::size_t bone_count)
{
    SkinFit fit { { rest, std::vector<Influences>(std::size_t(rest.cols())), 0 }, cluster_bones(rest, shapes, bone_count) };
    fit.skin.bone_count = fit.poses[0].size();
    for (int round = 0; round < alternations; ++round) {
        for (Eigen::Index v = 0; v < rest.cols(); ++v)
            fit.skin.influences[std::size_t(v)] = fit_influences(v, rest, shapes, fit.poses);
        const auto members = members_of(fit.skin);
        for (std::size_t s = 0; s < shapes.size(); ++s)
            sweep_bones(fit.skin, members, shapes[s], fit.poses[s], sweeps_per_round);
    }
    return fit;
}

BonePose fit_bones(const Skin& skin, const Eigen::Matrix3Xd& shape, BonePose start)
{
    sweep_bones(skin, members_of(skin), shape, start, sweeps_alone);
    return start;
}

} // namespace pliant
