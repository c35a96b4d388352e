// Blends of poses that stay where they are, looked at through the C runtime: they go from place to place.
#include "../tube.h"
#include "../twisted_bar.h"

#include "bake/bake.h"
#include "base/mesh/align.h"
#include "elastic/average/placement.h"
#include "output/asset/runtime_blender.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <utility>

using namespace pliant;

namespace {

struct Listener : Progress {
    std::vector<int> warnings;
    void warn(int number, const std::string&, const std::string&) override { warnings.push_back(number); }
};

// Turned about the x axis and moved.
void place(Positions& pose, double angle, double height)
{
    const Eigen::AngleAxisd turn(angle, Eigen::Vector3d::UnitX());
    pose = (pose * turn.toRotationMatrix().transpose()).eval();
    pose.col(1).array() += height;
}

PoseSet placed_tubes(double angle)
{
    PoseSet poses = tube_poses(3, { 8, 6 });
    poses.share_frame = true;
    place(poses.positions[1], angle, 5);
    place(poses.positions[2], -angle / 2, -2);
    return poses;
}

PoseSet placed_bar()
{
    PoseSet poses = twisted_bar(2, 6, 1.5);
    poses.share_frame = true;
    place(poses.positions[1], 1, 5);
    return poses;
}

// The largest step, without alignment, of a blend that goes from pose 0 to pose k in hundredths, over the mean step; then
// the distance from pose k at the end over the way.
std::pair<double, double> walk(RuntimeBlender& blender, const NormalizedPoses& set, std::size_t k)
{
    const std::size_t m = set.pose_count();
    Shape last = set.shapes[0];
    double largest = 0;
    for (int i = 1; i <= 100; ++i) {
        std::vector<float> w(m, 0.0f);
        w[k] = 0.01f * float(i);
        w[0] = 1 - w[k];
        const Shape shape = from_input_units(set, blender.positions(blender.solve(w, false)));
        largest = std::max(largest, (shape - last).norm());
        last = shape;
    }
    const double way = (set.shapes[k] - set.shapes[0]).norm();
    return { largest / (way / 100), (last - set.shapes[k]).norm() / way };
}

void check_walks(const PoseSet& poses, const BakeOptions& options)
{
    Listener listener;
    const BakedAsset baked = bake(poses, options, listener);
    CHECK(listener.warnings.empty());
    CHECK_FALSE(baked.report.input.is_aligned);
    CHECK(baked.report.check.meets_tolerance);
    RuntimeBlender blender(baked.bytes, "placed");
    const NormalizedPoses set = normalize(poses);
    for (std::size_t k = 1; k < set.pose_count(); ++k) {
        const auto [largest_step, off] = walk(blender, set, k);
        CAPTURE(k);
        CHECK(largest_step < 3);
        CHECK(off < 2e-3);
    }
}

} // namespace

TEST_CASE("averages of poses that stay where they are go from place to place")
{
    for (const double angle : { 0.0, 1.0 }) {
        CAPTURE(angle);
        check_walks(placed_tubes(angle), {});
    }
}

TEST_CASE("a polynomial and elements hold averages of solids in their places")
{
    for (const SurrogateKind kind : { SurrogateKind::quartic, SurrogateKind::cubature }) {
        BakeOptions options;
        options.surrogate = kind;
        check_walks(placed_bar(), options);
    }
}

TEST_CASE("at a pose the place is the pose's own, however far apart poses are")
{
    PoseSet poses = tube_poses(3, { 8, 6 });
    poses.share_frame = true;
    place(poses.positions[1], 0.5, 3000);
    place(poses.positions[2], -0.5, -8000);
    const NormalizedPoses set = normalize(poses);
    const Placement placement(set);
    for (std::size_t k = 0; k < 3; ++k) {
        Shape shape = set.shapes[k];
        apply({ Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(), { 4, 5, 6 } }, shape);
        placement.place(corner_weights(3, k), shape);
        CHECK((shape - set.shapes[k]).norm() < 1e-9 * set.shapes[k].norm());
    }
}

TEST_CASE("poses that turn too far are aligned, with a warning")
{
    PoseSet poses = placed_tubes(3);
    CHECK(normalize(poses).frame.size() == 0);
    CHECK(normalize(placed_tubes(1)).frame.size() > 0);
    BakeOptions options;
    options.time_limit = 0;
    Listener listener;
    CHECK(bake(poses, options, listener).report.input.is_aligned);
    CHECK(std::count(listener.warnings.begin(), listener.warnings.end(), 4413) == 1);
}

// The mean has no width left: how a pose turns against it is a matter of rounding.
TEST_CASE("poses turned by half a turn are aligned, thin bodies that bend to both sides are not")
{
    PoseSet poses = twisted_bar(2, 6, 0.7);
    poses.share_frame = true;
    CHECK(normalize(poses).frame.size() > 0);
    for (const double angle : { 3.0, 3.14159265358979323846 }) {
        CAPTURE(angle);
        PoseSet turned = poses;
        place(turned.positions[1], angle, 0);
        CHECK(normalize(turned).frame.size() == 0);
    }
    for (int axis = 0; axis < 3; ++axis) {
        CAPTURE(axis);
        PoseSet turned = tube_poses(2, { 8, 6 });
        turned.share_frame = true;
        turned.positions[1] = turned.positions[0];
        for (int other = 0; other < 3; ++other)
            if (other != axis) turned.positions[1].col(other) *= -1;
        CHECK(normalize(turned).frame.size() == 0);
    }
    PoseSet bent = tube_poses(2, { 8, 60 });
    bent.share_frame = true;
    const double length = bent.positions[0].maxCoeff() - bent.positions[0].minCoeff();
    Eigen::Index along = 0;
    (bent.positions[0].colwise().maxCoeff() - bent.positions[0].colwise().minCoeff()).maxCoeff(&along);
    bent.positions[1] = bent.positions[0];
    for (int side = 0; side < 2; ++side) {
        Positions& pose = bent.positions[std::size_t(side)];
        const Eigen::ArrayXd s = pose.col(along).array() / length;
        pose.col((along + 1) % 3).array() += (side ? -1 : 1) * length * s.square();
    }
    CHECK(normalize(bent).frame.size() > 0);
}

TEST_CASE("layers that turn a body, or each bend a thin one a little, stay where the linear sum is")
{
    PoseSet turned = tube_poses(3, { 8, 6 });
    turned.positions[1] = turned.positions[0];
    place(turned.positions[1], 1, 0);
    place(turned.positions[2], -0.7, 0);
    PoseSet bent = tube_poses(4, { 14, 6 });
    bent.positions[1] = bent.positions[2] = Tube { 14, 6 }.pose(0.3, 0);
    const Eigen::AngleAxisd quarter(1.5707963267948966, Eigen::Vector3d::UnitZ());
    bent.positions[2] = (bent.positions[2] * quarter.toRotationMatrix().transpose()).eval();
    bent.positions[3] = Tube { 14, 6 }.pose(0, 0.3);
    for (PoseSet* poses : { &turned, &bent }) {
        poses->blend = Blend::layers;
        BakeOptions options;
        options.energy.blend = Blend::layers;
        Listener listener;
        const BakedAsset baked = bake(*poses, options, listener);
        CHECK_FALSE(baked.report.input.is_aligned);
        for (const BlendCheck& check : baked.report.check.blends) CHECK(check.error.largest_distance < 2e-2);
        RuntimeBlender blender(baked.bytes, "layers");
        const NormalizedPoses set = normalize(*poses);
        const std::vector<float> zero(set.pose_count() - 1, 0.0f);
        const Shape rest = from_input_units(set, blender.positions(blender.solve(zero, false)));
        CHECK((rest - set.shapes[0]).norm() < 2e-4 * set.shapes[0].norm()); // the basis is rounded
    }
}
