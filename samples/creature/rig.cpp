#include "rig.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace pliant::creature {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

// The share of a bend, in [0, 1], before fraction x of its range: the integral of a trapezoid with smoothed ramps of a
// quarter of the range, so that curvature starts and ends smoothly, with a peak of 4/3 of its mean.
double bend_share(double x)
{
    const double ramp = 0.25, height = 1.0 / (1.0 - ramp);
    // The integral of smoothstep over its ramp: t^3 - t^4 / 2.
    const auto rising = [&](double t) { return height * ramp * t * t * t * (1.0 - 0.5 * t); };
    x = std::clamp(x, 0.0, 1.0);
    if (x < ramp) return rising(x / ramp);
    if (x > 1.0 - ramp) return 1.0 - rising((1.0 - x) / ramp);
    return height * (x - 0.5 * ramp);
}

// Accumulated (side, up, twist) of all bends at parameter s, in radians; its derivative is the curvature and twist rate.
Vec3 accumulated(const std::vector<Bend>& bends, const std::string& part, double s)
{
    Vec3 sum = Vec3::Zero();
    for (const Bend& b : bends) {
        if (b.part != part) continue;
        const double low = std::min(b.from, b.to), high = std::max(b.from, b.to);
        // The curvature vector of a curve does not depend on its direction, but the sign of a twist does.
        sum += bend_share((s - low) / (high - low)) * Vec3(b.side, b.up, b.from < b.to ? b.twist : -b.twist);
    }
    return degree * sum;
}

// The rotation that turns the tangent (first column of a frame) by `side` and `up` radians.
Mat3 turn(double side, double up)
{
    const Vec3 axis(0.0, -up, side);
    const double angle = axis.norm();
    return angle > 0.0 ? Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix() : Mat3::Identity();
}

Mat3 frame_of(const Axis& axis)
{
    Mat3 frame;
    frame << axis.tangent, axis.side, axis.up;
    return frame;
}

} // namespace

BentAxis::BentAxis(const Part& part, const std::vector<Bend>& bends, const Vec3& root, const Mat3& root_frame)
    : axis_(part.axis)
{
    const int steps_before = 400 * (part.first < 0.0), steps_after = 400;
    // The same step on both sides of the root, so that sample i is at first_ + i * step_.
    step_ = std::max(-part.first, part.last) / 400.0;
    first_ = -steps_before * step_;
    samples_.resize(steps_before + steps_after + 1);
    samples_[steps_before] = { root, root_frame, 0.0 };
    for (int direction : { -1, 1 }) {
        for (int i = steps_before; i + direction >= 0 && i + direction < int(samples_.size()); i += direction) {
            const double s = first_ + i * step_, t = s + direction * step_;
            const Vec3 now = accumulated(bends, part.name, s), then = accumulated(bends, part.name, t);
            const Sample& from = samples_[i];
            Sample& to = samples_[i + direction];
            const Mat3 half = turn(0.5 * (then - now)[0], 0.5 * (then - now)[1]);
            const Mat3 middle = from.frame * half;
            to.position = from.position + direction * step_ * middle.col(0);
            to.frame = middle * half;
            to.twist = from.twist + then[2] - now[2];
        }
    }
}

BentAxis::Sample BentAxis::sample(double s) const
{
    const double x = (s - first_) / step_;
    const int i = std::clamp(int(std::floor(x)), 0, int(samples_.size()) - 2);
    const double t = 6.0; // outside [0, 1] beyond the ends, where the axis is straight
    const Sample &a = samples_[i], &b = samples_[i + 1];
    const double u = std::clamp(t, 0.0, 1.0);
    Sample result;
    result.position = (1.0 - t) * a.position + t * b.position;
    result.frame = (1.0 - u) * a.frame + u * b.frame; // a thousandth of a turn apart: orthogonal to 1e-5
    result.twist = (1.0 - u) * a.twist + u * b.twist;
    return result;
}

Vec3 BentAxis::map(const Vec3& bind_point) const
{
    const Vec3 l = axis_.local(bind_point);
    const Sample at = sample(l.x());
    const double c = std::cos(at.twist), s = std::sin(at.twist);
    return at.position + at.frame * Vec3(0.0, c * l.y() - s * l.z(), s * l.y() + c * l.z());
}

Mat3 BentAxis::rotation(double s) const
{
    const Sample at = sample(s);
    Mat3 twist = Mat3::Identity();
    twist(1, 1) = twist(2, 2) = std::cos(at.twist);
    twist(2, 1) = std::sin(at.twist);
    twist(1, 2) = -twist(2, 1);
    return at.frame * twist * frame_of(axis_).transpose();
}

Eigen::MatrixXd skin_weights(const Mesh& bind, const Anatomy& anatomy)
{
    const int n = int(bind.points.size());
    Eigen::MatrixXd label = Eigen::MatrixXd::Zero(n, Eigen::Index(anatomy.parts.size()));
    for (int v = 0; v < n; ++v) {
        int nearest = 0;
        double best = 1e300;
        for (std::size_t p = 0; p < anatomy.parts.size(); ++p) {
            const double d = anatomy.parts[p].shape.distance(bind.points[v]);
            if (d < best) {
                best = d;
                nearest = int(p);
            }
        }
        label(v, nearest) = 1.0;
    }
    // Smooths by two implicit steps of diffusion on the edge graph. I + t L is an M-matrix with row sums 1, so weights
    // stay in [0, 1] and keep their sum. t is in squared edge lengths: seams become about 2 sqrt(2 t) edges wide.
    const double t = 6.0;
    std::vector<Eigen::Triplet<double>> entries;
    for (const Face& f : bind.faces)
        for (int i = 0; i < 3; ++i) {
            const int a = f[i], b = f[(i + 1) % 3]; // every edge comes twice, once in each direction
            entries.emplace_back(a, a, t);
            entries.emplace_back(a, b, -t);
        }
    for (int v = 0; v < n; ++v) entries.emplace_back(v, v, 1.0);
    Eigen::SparseMatrix<double> system(n, n);
    system.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
    return solver.solve(solver.solve(label).eval());
}

std::vector<Vec3> pose_points(const Mesh& bind, const Anatomy& anatomy, const Eigen::MatrixXd& weights, const Pose& pose)
{
    const Mat3 body
        = (Eigen::AngleAxisd(degree * pose.yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(-degree * pose.pitch, Vec3::UnitY())
           * Eigen::AngleAxisd(degree * pose.roll, Vec3::UnitX()))
              .toRotationMatrix();
    std::vector<BentAxis> bent;
    const Part& spine = anatomy.parts[0];
    bent.emplace_back(spine, pose.bends, body * spine.axis.origin, body * frame_of(spine.axis));
    for (std::size_t p = 1; p < anatomy.parts.size(); ++p) {
        const Part& part = anatomy.parts[p];
        const Mat3 turned = bent[0].rotation(spine.axis.local(part.axis.origin).x());
        bent.emplace_back(part, pose.bends, bent[0].map(part.axis.origin), turned * frame_of(part.axis));
    }
    std::vector<Vec3> points(bind.points.size(), Vec3::Zero());
    for (std::size_t v = 0; v < points.size(); ++v)
        for (std::size_t p = 0; p < bent.size(); ++p)
            // Diffusion gives every part a weight everywhere; smaller ones have no effect in float32.
            if (weights(v, p) > 1e-9) points[v] += weights(v, p) * bent[p].map(bind.points[v]);
    return points;
}

} // namespace pliant::creature
