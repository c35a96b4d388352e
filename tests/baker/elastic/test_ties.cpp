// Characters in several parts: which ties they get, what these do, and whole bakes.
#include "../parts_mesh.h"

#include "bake/bake.h"
#include "bake/make_energy.h"
#include "elastic/average/hessian.h"
#include "elastic/average/newton.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/energy/discrete_shells.h"
#include "elastic/parts/find_ties.h"
#include "elastic/parts/tied_energy.h"
#include "output/asset/runtime_blender.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).norm() / b.norm(); }

Shape noise(Eigen::Index size, double scale)
{
    Shape out(size);
    std::uint64_t state = 7;
    for (double& x : out) {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        x = scale * (double(state >> 33) / double(1u << 31) - 0.5);
    }
    return out;
}

Eigen::MatrixXd dense_hessian(const Energy& energy, const Weights& w, const Shape& y, HessianKind kind)
{
    HessianAssembler assembler(energy);
    assembler.assemble(w, y, kind);
    return Eigen::MatrixXd(assembler.matrix()).selfadjointView<Eigen::Lower>();
}

struct Fixture {
    explicit Fixture(const PartsMesh& mesh = {}, std::size_t pose_count = 3)
        : poses(mesh.poses(pose_count))
        , set(normalize(poses))
        , energy(make_energy(set, EnergyOptions()))
        , ties(*ties_of(*energy))
    {
    }
    PoseSet poses;
    NormalizedPoses set;
    std::unique_ptr<Energy> energy;
    const TieSet& ties;
};

} // namespace

TEST_CASE("parts are found and each hangs on the body")
{
    const Fixture f;
    REQUIRE(f.ties.parts.count() == 4);
    CHECK(f.ties.parts.surface_count == 3);
    CHECK(f.ties.tree.parents == std::vector<std::size_t> { no_part, 0, 0, 0 });
    std::vector<std::size_t> counts(4, 0);
    for (const Tie& tie : f.ties.ties) {
        ++counts[tie.part];
        CHECK(tie.vertices[0] != tie.vertices[1]);
    }
    CHECK(counts[0] == 0);
    CHECK(counts[1] >= 12);
    CHECK(counts[2] >= 40);
    CHECK(counts[3] == 1);
}

TEST_CASE("a surface in one part has no ties")
{
    const NormalizedPoses set = normalize(tube_poses(2));
    CHECK(find_ties(set).ties.empty());
    CHECK(ties_of(*make_energy(set, EnergyOptions())) == nullptr);
}

TEST_CASE("ties vanish at the poses, and exactly six motions are free")
{
    const Fixture f;
    for (std::size_t k = 0; k < f.set.pose_count(); ++k) {
        const Weights w = corner_weights(f.set.pose_count(), k);
        CHECK(std::abs(energy_value(*f.energy, w, f.set.shapes[k])) < 1e-20);
        const Eigen::MatrixXd hessian = dense_hessian(*f.energy, w, f.set.shapes[k], HessianKind::exact);
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian).eigenvalues();
        const double largest = values[values.size() - 1];
        CHECK(values[0] > -1e-12 * largest);
        CHECK(values[5] < 1e-12 * largest);
        CHECK(values[6] > 1e-8 * largest);
    }
}

namespace {

// Two rigid tubes; the second turns by these angles about a skew hinge near the end of the first, to which its tied vertices
// lie askew. Closed at both ends they are stiff, open ones give way.
PoseSet hinged_tubes(const std::vector<double>& angles, bool is_closed)
{
    const Eigen::Vector3d hinge(3.2, 0.1, 0), axis = Eigen::Vector3d(0.3, 0.2, 1).normalized(),
                                              along = Eigen::Vector3d(1, 0.4, 0.3).normalized();
    const Eigen::Vector3d across = along.cross(Eigen::Vector3d::UnitY()).normalized(), up = along.cross(across);
    const std::uint32_t rings = 7, sides = 8, body = rings * sides;
    PoseSet poses;
    for (const double angle : angles) {
        Positions positions(2 * body + (is_closed ? 4 : 0), 3);
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
        const auto arm = [&](double ring, double x, double y) {
            return hinge + turn * ((0.35 * ring - 0.2) * along + 0.3 * (x * across + y * up));
        };
        for (std::uint32_t i = 0; i < body; ++i) {
            const double around = 6.283185307179586 * (i % sides) / sides, ring = i / sides;
            positions.row(i) << 0.5 * ring, 0.5 * std::cos(around), 0.5 * std::sin(around);
            positions.row(body + i) = arm(ring, std::cos(around), std::sin(around));
        }
        for (std::uint32_t end = 0; is_closed && end < 2; ++end) {
            positions.row(2 * body + end) << 0.5 * (rings - 1) * end, 0, 0;
            positions.row(2 * body + 2 + end) = arm((rings - 1) * end, 0, 0);
        }
        poses.positions.push_back(positions);
        poses.names.push_back("turned");
    }
    for (std::uint32_t i = 0; i < 2 * body; ++i) {
        const std::uint32_t ring = i / sides % rings, next = i / sides * sides + (i + 1) % sides;
        const std::uint32_t centre = 2 * body + 2 * (i / body) + (ring > 0);
        if (is_closed && ring == 0) poses.triangles.push_back({ next, i, centre });
        if (is_closed && ring == rings - 1) poses.triangles.push_back({ i, next, centre });
        if (ring == rings - 1) continue;
        poses.triangles.push_back({ i, next, next + sides });
        poses.triangles.push_back({ i, next + sides, i + sides });
    }
    return poses;
}

Shape shape_of(const NormalizedPoses& set, const Positions& positions)
{
    std::vector<float> values;
    for (Eigen::Index v = 0; v < positions.rows(); ++v)
        for (Eigen::Index c = 0; c < 3; ++c) values.push_back(float(positions(v, c)));
    return from_input_units(set, values);
}

// The energy of a character with one joint, with it or with the ties in its place.
std::unique_ptr<Energy> with_joint(const NormalizedPoses& set, bool is_used)
{
    TieSet ties = find_ties(set);
    std::vector<double> stiffness;
    for (const Tie& tie : ties.ties) stiffness.push_back(tie.stiffness);
    auto energy = std::make_unique<TiedEnergy>(std::make_unique<DiscreteShells>(set, ShellOptions()), std::move(ties));
    energy->choose(stiffness, { is_used });
    energy->drop_unused();
    return energy;
}

} // namespace

TEST_CASE("derivatives are finite differences, projected Hessians are positive semidefinite")
{
    const Fixture f;
    const NormalizedPoses hinged = normalize(hinged_tubes({ 0, 0.8, 2 }, false));
    const auto jointed = with_joint(hinged, true);
    const Weights w = Eigen::Vector3d(0.2, 0.5, 0.3);
    for (const auto& [energy, set] : { std::make_pair(f.energy.get(), &f.set), std::make_pair(jointed.get(), &hinged) }) {
        const Shape y = set->shapes[1] + noise(set->dof_count(), 0.02), direction = noise(set->dof_count(), 1);
        const std::size_t first = without_ties(*energy).element_count();
        REQUIRE(energy->element_count() > first);
        for (std::size_t e = first; e < energy->element_count(); ++e) {
            std::size_t count = 0;
            const std::uint32_t* vertices = energy->element_vertices(e, count);
            Eigen::VectorXd x(3 * Eigen::Index(count));
            gather(vertices, count, y, x.data());
            const Eigen::VectorXd along = direction.head(x.size()).normalized();
            ElementResult at, plus, minus;
            const auto evaluate = [&](double step, HessianKind kind, ElementResult& result) {
                const Eigen::VectorXd moved = x + step * along;
                energy->evaluate(e, w.data(), moved.data(), Order::hessian, kind, result);
            };
            evaluate(0, HessianKind::exact, at);
            evaluate(1e-5, HessianKind::exact, plus);
            evaluate(-1e-5, HessianKind::exact, minus);
            CHECK(at.gradient.dot(along) == doctest::Approx((plus.value - minus.value) / 2e-5).epsilon(1e-6));
            CHECK(relative(at.hessian * along, (plus.gradient - minus.gradient) / 2e-5) < 1e-6);
            ElementResult projected;
            evaluate(0, HessianKind::projected, projected);
            const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected.hessian).eigenvalues();
            CHECK(values[0] > -1e-12 * values[values.size() - 1]);
        }
    }
}

TEST_CASE("a joint turns a rigid part in step, and is rest at the poses")
{
    const NormalizedPoses set = normalize(hinged_tubes({ 0, 0.8, 2 }, true));
    const TieSet ties = find_ties(set);
    REQUIRE(ties.joints.size() == 1);
    CHECK(ties.joints[0].terms.size() == 4);
    CHECK(ties.joints[0].tie_count == ties.ties.size());
    const auto energy = with_joint(set, true), other = with_joint(set, false);
    CHECK(energy->element_count() == without_ties(*energy).element_count() + 4);
    CHECK(other->element_count() == without_ties(*energy).element_count() + ties.ties.size());
    for (std::size_t k = 0; k < 3; ++k) {
        const Weights w = corner_weights(3, k);
        CHECK(std::abs(energy_value(*energy, w, set.shapes[k])) < 1e-20);
        const Eigen::VectorXd values
            = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense_hessian(*energy, w, set.shapes[k], HessianKind::exact))
                  .eigenvalues();
        CHECK(values[5] < 1e-12 * values[values.size() - 1]);
        CHECK(values[6] > 1e-8 * values[values.size() - 1]);
    }

    // Where a shape is another pose than the weights say, the part is off by most of its radius or more.
    CHECK(measure_turn_drift(ties, corner_weights(3, 2), set.shapes[0]).largest > 0.7);
    CHECK(measure_turn_drift(ties, corner_weights(3, 2), set.shapes[2]).largest < 1e-6);

    // Half and half between two poses is half the angle about the same hinge, and that is no drift.
    const Weights w = Eigen::Vector3d(0.5, 0, 0.5);
    Shape half = shape_of(set, hinged_tubes({ 1 }, true).positions[0]);
    CHECK(measure_drift(ties, set, w, half).largest < 1e-3); // not 0: the joint is found to a part of what it hardly matters
    const auto farthest = [&](const Energy& one) {
        Shape y = NewtonSolver(one, set, default_solver()).minimize(w, half, NewtonOptions()).y;
        align_to(set, half, y);
        double out = 0;
        for (std::uint32_t v = 0; v < std::uint32_t(set.masses.size()); ++v)
            out = std::max(out, (point(y, v) - point(half, v)).norm() / set.diagonal);
        return out;
    };
    const double with = farthest(*energy), without = farthest(*other);
    CAPTURE(with);
    CAPTURE(without);
    CHECK(with < drift_limit);
    CHECK(with < 0.8 * without);
}

TEST_CASE("turns of layers add up at a joint as far as its linear axes allow, and a bake warns of the rest")
{
    const PoseSet poses = hinged_tubes({ 0, 1, 0.5 }, true);
    TieSet ties = find_ties(normalize(poses));
    REQUIRE(ties.joints.size() == 1);
    // The rotation nearest to 1 + v (exp(i t) - 1) in the plane of the hinge.
    for (const Weights& v :
         { Weights(Eigen::Vector2d(1, 0)), Weights(Eigen::Vector2d(-1, 0)), Weights(Eigen::Vector2d(2, 0)),
           Weights(Eigen::Vector2d(1, 1)), Weights(Eigen::Vector2d(1, -1)) }) {
        const std::complex<double> one(1, 0), i(0, 1);
        const std::complex<double> axis = one + v[0] * (std::exp(i) - one) + v[1] * (std::exp(0.5 * i) - one);
        const JointTurn turn = turn_of_layers(ties.joints[0], v);
        CAPTURE(weights_text(v));
        CHECK(turn.angle == doctest::Approx(std::abs(std::arg(axis))).epsilon(1e-3));
        CHECK(turn.sum == doctest::Approx(std::abs(v[0] + 0.5 * v[1])).epsilon(1e-3));
        CHECK(turn.miss == doctest::Approx(std::abs(std::arg(axis) - v[0] - 0.5 * v[1])).epsilon(0.01));
    }
    ties.joints[0].is_used = true;
    const NormalizedPoses set = normalize(poses);
    const auto worst = [&](double low) {
        return start_tie_report(ties, set, WeightDomain::box({ { low, 1 }, { low, 1 } })).turn;
    };
    CHECK(worst(0).weights == Eigen::Vector2d(1, 1));
    CHECK(worst(-1).weights == Eigen::Vector2d(-1, -1));
    CHECK(start_tie_report(ties, set, WeightDomain::simplex(3)).turn.turn.miss == 0);
}

TEST_CASE("a part that turns far gets a joint or ties, whatever keeps its place")
{
    struct Case {
        bool is_closed;
        Continuity continuity;
        std::size_t joint_count; // a joint would dent the open tube
    };
    for (const Case& c : { Case { false, Continuity::off, 0 }, Case { true, Continuity::off, 1 },
                           Case { false, Continuity::automatic, 0 } }) {
        CAPTURE(c.is_closed);
        BakeOptions options;
        options.energy.continuity = c.continuity;
        options.tolerance = 3e-3;
        options.check_count = 8;
        options.fresh_count = 4;
        Progress silent;
        const PoseSet poses = hinged_tubes({ 0, 0.8, 2 }, c.is_closed);
        const BakedAsset baked = bake(poses, options, silent);
        CHECK(baked.report.check.mean_error < 3e-3);
        REQUIRE(baked.report.check.ties.has_value());
        CHECK(baked.report.check.ties->joint_count == c.joint_count);
        CHECK(baked.report.check.ties->blends.drift.largest < drift_limit);
    }
}

TEST_CASE("ties do not see rigid motions, the order of the poses or the unit")
{
    const Fixture f;
    const Weights w = Eigen::Vector3d(0.2, 0.5, 0.3);
    const Shape y = f.set.shapes[1] + noise(f.set.dof_count(), 0.02);
    const double value = energy_value(*f.energy, w, y);
    Shape moved = y;
    RigidMotion motion;
    motion.rotation = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    motion.translation = Eigen::Vector3d(3, -1, 2);
    apply(motion, moved);
    CHECK(energy_value(*f.energy, w, moved) == doctest::Approx(value).epsilon(1e-9));

    PoseSet scaled = f.poses;
    for (Positions& positions : scaled.positions) positions *= 1000;
    const NormalizedPoses scaled_set = normalize(scaled);
    CHECK(energy_value(*make_energy(scaled_set, EnergyOptions()), w, y) == doctest::Approx(value).epsilon(1e-6));

    // A mirrored part is not at rest: the place knows sides.
    const Tie& tie = f.ties.ties[0];
    const auto& v = tie.vertices;
    const Eigen::Vector3d a = point(f.set.shapes[0], v[1]), b = point(f.set.shapes[0], v[2]),
                          c = point(f.set.shapes[0], v[3]);
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized(), x = point(f.set.shapes[0], v[0]);
    const Eigen::Vector3d mirrored = x - 2 * normal * normal.dot(x - a);
    CHECK((tie_place(tie_vectors(tie, mirrored, a, b, c)) - tie.rest.col(0)).norm()
          == doctest::Approx(2 * std::abs(normal.dot(x - a))).epsilon(0.5));
}

TEST_CASE("touching parts that lie in one plane are held to first order")
{
    // Two flat squares side by side, in all poses in the same plane.
    PoseSet poses;
    poses.triangles = { { 0, 1, 2 }, { 0, 2, 3 }, { 4, 5, 6 }, { 4, 6, 7 } };
    Positions square(8, 3);
    square << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0;
    poses.positions = { square, 1.2 * square };
    poses.names = { "a", "b" };
    const NormalizedPoses set = normalize(poses);
    const auto energy = make_energy(set, EnergyOptions());
    REQUIRE(ties_of(*energy) != nullptr);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                                       dense_hessian(*energy, corner_weights(2, 0), set.shapes[0], HessianKind::exact))
                                       .eigenvalues();
    CHECK(values[5] < 1e-12 * values[23]);
    CHECK(values[6] > 1e-8 * values[23]);
}

namespace {

// A box from one corner to the opposite one, its vertices and faces added to a pose set; `high` may differ between the
// poses.
void add_box(PoseSet& poses, const Eigen::RowVector3d& low, const std::vector<Eigen::RowVector3d>& high)
{
    const std::uint32_t first = poses.positions.empty() ? 0 : std::uint32_t(poses.positions[0].rows());
    poses.positions.resize(high.size());
    poses.names.resize(high.size(), "boxes");
    for (std::size_t k = 0; k < high.size(); ++k) {
        Positions& positions = poses.positions[k];
        positions.conservativeResize(first + 8, 3);
        for (std::uint32_t i = 0; i < 8; ++i)
            for (int c = 0; c < 3; ++c) positions(first + i, c) = i >> c & 1 ? high[k][c] : low[c];
    }
    static const std::uint32_t sides[6][4]
        = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
    for (const auto& side : sides) {
        poses.triangles.push_back({ first + side[0], first + side[1], first + side[2] });
        poses.triangles.push_back({ first + side[0], first + side[2], first + side[3] });
    }
}

using Row = Eigen::RowVector3d;

} // namespace

TEST_CASE("what stands on a large face hangs on it, far from its corners")
{
    // Two posts, nearer to one another than to any vertex of the plate; one grows, then the other.
    PoseSet poses;
    add_box(poses, Row(-2, -0.1, -0.5), { Row(2, 0, 0.5), Row(2, 0, 0.5), Row(2, 0, 0.5) });
    add_box(poses, Row(-0.4, 0, -0.1), { Row(-0.2, 0.5, 0.1), Row(-0.2, 1.5, 0.1), Row(-0.2, 0.5, 0.1) });
    add_box(poses, Row(0, 0, -0.1), { Row(0.2, 0.5, 0.1), Row(0.2, 0.5, 0.1), Row(0.2, 1.5, 0.1) });
    const NormalizedPoses set = normalize(poses);
    const TieSet ties = find_ties(set);
    CHECK(ties.tree.parents == std::vector<std::size_t> { no_part, 0, 0 });
    CHECK(ties.distances[1] < 0.01 * set.diagonal);
    const auto energy = make_energy(set, EnergyOptions());
    const Weights w = Eigen::Vector3d(0.2, 0.5, 0.3);
    const Shape y = NewtonSolver(*energy, set, default_solver()).minimize(w, set.shapes[0], NewtonOptions()).y;
    CHECK(measure_drift(*ties_of(*energy), set, w, y).largest < drift_limit);
}

TEST_CASE("a plate under a heavier post is tied where the post stands")
{
    PoseSet poses;
    add_box(poses, Row(-2, -2, -0.1), { Row(2, 2, 0), Row(2, 2, 0) });
    add_box(poses, Row(-1.2, -1.2, 0), { Row(1.2, 1.2, 2.6), Row(1.2, 1.2, 3) });
    const NormalizedPoses set = normalize(poses);
    const TieSet ties = find_ties(set);
    REQUIRE(ties.tree.parents == std::vector<std::size_t> { 1, no_part });
    CHECK(ties.distances[0] < 0.01 * set.diagonal);
    for (const Tie& tie : ties.ties) {
        CHECK(tie.part == 0);
        CHECK(tie.vertices[0] >= 8);
        CHECK(tie.vertices[1] < 8);
    }
    const Eigen::MatrixXd hessian
        = dense_hessian(*make_energy(set, EnergyOptions()), corner_weights(2, 0), set.shapes[0], HessianKind::exact);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian).eigenvalues();
    CHECK(values[5] < 1e-12 * values[values.size() - 1]);
    CHECK(values[6] > 1e-8 * values[values.size() - 1]);
}

TEST_CASE("what is next to a part much smaller than the way to it is tied")
{
    PoseSet poses;
    add_box(poses, Row(0, 0, 0), { Row(4, 1, 1), Row(4, 1, 1.2) });
    add_box(poses, Row(4.3, 0.5, 0.5), { Row(4.33, 0.53, 0.53), Row(4.33, 0.53, 0.53) });
    add_box(poses, Row(4.9, 0.4, 0.4), { Row(5.1, 0.6, 0.6), Row(5.1, 0.6, 0.6) });
    const NormalizedPoses set = normalize(poses);
    const TieSet ties = find_ties(set);
    std::vector<std::size_t> counts(ties.parts.count(), 0);
    for (const Tie& tie : ties.ties) ++counts[tie.part];
    for (std::size_t p = 0; p < counts.size(); ++p) CHECK((counts[p] > 0) == (ties.tree.parents[p] != no_part));
    CHECK(ties.tree.parents[2] == 1);
}

namespace {

// Two strips of squares along x that share the border y = 0 only in space: the lower one has vertices at x = 0, 1, 2, ..
// there, the upper one at 0, 2, 4, .., and the two are one part by the square at their end if `is_joined`.
PoseSet cracked_sheet(bool is_joined)
{
    PoseSet poses;
    const std::uint32_t n = 9;
    std::vector<Eigen::RowVector3d> rest;
    for (std::uint32_t i = 0; i < n; ++i) rest.emplace_back(i, -1, 0);
    for (std::uint32_t i = 0; i < n; ++i) rest.emplace_back(i, 0, 0);
    const std::uint32_t upper = 2 * n, half = n / 2 + 1;
    for (std::uint32_t i = 0; i < half; ++i) rest.emplace_back(2 * i, 0.001, 0);
    for (std::uint32_t i = 0; i < half; ++i) rest.emplace_back(2 * i, 2, 0);
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
        poses.triangles.push_back({ i, i + 1, n + i + 1 });
        poses.triangles.push_back({ i, n + i + 1, n + i });
    }
    const auto at = [&](std::uint32_t i) { return is_joined && i == 0 ? n : upper + i; };
    for (std::uint32_t i = 0; i + 1 < half; ++i) {
        poses.triangles.push_back({ at(i), at(i + 1), upper + half + i + 1 });
        poses.triangles.push_back({ at(i), upper + half + i + 1, upper + half + i });
    }
    for (const double bend : { 0.0, 1.5 }) {
        Positions positions(Eigen::Index(rest.size()), 3);
        for (std::size_t v = 0; v < rest.size(); ++v)
            positions.row(Eigen::Index(v)) = Tube::place(bend, 0, rest[v].x() * 6 / n, rest[v].z(), rest[v].y());
        poses.positions.push_back(positions);
        poses.names.push_back("bent");
    }
    return poses;
}

} // namespace

TEST_CASE("borders that lie on borders are tied to them")
{
    for (const bool is_joined : { false, true }) {
        const NormalizedPoses set = normalize(cracked_sheet(is_joined));
        const TieSet ties = find_ties(set);
        CHECK(ties.parts.count() >= 2); // touching in one vertex is two
        // The lower strip's vertices between the ends of the upper one's edges, at least.
        std::vector<std::uint32_t> seams;
        for (std::size_t i = ties.ties.size() - ties.seam_count; i < ties.ties.size(); ++i)
            seams.push_back(ties.ties[i].vertices[0]);
        for (const std::uint32_t v : { 10u, 12u, 14u, 16u }) CHECK(std::find(seams.begin(), seams.end(), v) != seams.end());
        for (const std::uint32_t v : seams) CHECK(v >= 9); // never a vertex that lies on no other border
        for (const std::uint32_t v : seams) CHECK(v < 23);
    }
}

TEST_CASE("lips that touch at rest and open in one of many poses are not tied")
{
    PoseSet poses = cracked_sheet(true);
    const Positions shut = poses.positions[0];
    while (poses.positions.size() < 11) poses.positions.push_back(shut), poses.names.push_back("shut");
    const std::size_t seams_shut = find_ties(normalize(poses)).seam_count;
    CHECK(seams_shut > 0);
    Positions open = shut; // by 0.15 of an edge, which is 0.04 of it in the root mean square over all poses
    const Eigen::RowVector3d across = (shut.row(9) - shut.row(0)).normalized();
    for (Eigen::Index v = 19; v < 19 + 4; ++v) open.row(v) += 0.15 * (shut.row(20) - shut.row(19)).norm() * across;
    poses.positions.push_back(open), poses.names.push_back("open");
    const TieSet ties = find_ties(normalize(poses));
    CHECK(ties.seam_count == 0);
}

TEST_CASE("ties are calibrated so that parts that rotate far keep their place")
{
    PartsMesh mesh;
    mesh.eye_turn = 1.2;
    const NormalizedPoses set = normalize(mesh.poses(3));
    const auto plain = tie_parts(std::make_unique<DiscreteShells>(set, ShellOptions()), find_ties(set)),
               calibrated = make_energy(set, EnergyOptions());
    const auto worst_drift = [&](const Energy& energy) {
        NewtonSolver solver(energy, set, default_solver());
        double worst = 0;
        for (const Eigen::Vector3d& w : { Eigen::Vector3d(0.5, 0.5, 0), Eigen::Vector3d(0, 0.4, 0.6),
                                          Eigen::Vector3d(0.3, 0, 0.7), Eigen::Vector3d(0.3, 0.3, 0.4) })
            worst = std::max(
                worst,
                measure_drift(*ties_of(energy), set, w, solver.minimize(w, set.shapes[0], NewtonOptions()).y).largest);
        return worst;
    };
    const double before = worst_drift(*plain), after = worst_drift(*calibrated);
    CAPTURE(before);
    CAPTURE(after);
    CHECK(after < 0.6 * before);
    CHECK(after < drift_limit);
    const TieSet ties = find_ties(set);
    CHECK(ties.ties.size() == ties_of(*calibrated)->ties.size());

    // No joint holds the eye, since the body bends, but its turn is seen: in another pose than the weights say it is off by
    // its radius.
    CHECK(ties.joints.empty());
    CHECK(measure_turn_drift(ties, corner_weights(3, 1), set.shapes[0]).largest > 0.9);
    CHECK(measure_turn_drift(ties, corner_weights(3, 1), set.shapes[1]).largest < 1e-6);
}

TEST_CASE("what is wrong with parts is said")
{
    struct Listener : Progress {
        std::vector<int> numbers;
        void warn(int number, const std::string&, const std::string&) override { numbers.push_back(number); }
    } heard;
    TieReport report;
    report.parts = { { 0, 0, 100, 0, 0 }, { 5, 0, 3, 12, 0.01 } };
    warn_about_ties(report, {}, heard);
    CHECK(heard.numbers.empty());
    report.parts.push_back({ 8, 5, 3, 0, 0.01 });
    report.parts.push_back({ 11, 0, 3, 12, 0.3 });
    report.blends = { { 0.02, 1, 6 }, Eigen::Vector2d(0.5, 0.5) };
    warn_about_ties(report, {}, heard);
    report.blends = { { 0.002, 1, 6 }, Eigen::Vector2d(0.5, 0.5) };
    report.turning = { { 0.2, 1, 6 }, Eigen::Vector2d(0.5, 0.5) };
    report.turn = { { 0.5, 1, 0.5 }, 1, Eigen::Vector2d(-1, 0) };
    warn_about_ties(report, {}, heard);
    CHECK(heard.numbers == std::vector<int> { 4409, 4410, 4408, 4409, 4410, 4408, 4414 });
    use_file_numbers({ 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21 }, report);
    CHECK(report.parts[2].vertex == 18);
    CHECK(report.blends.drift.vertex == 16);
}

TEST_CASE("a character in several parts bakes, and its parts keep their place")
{
    const PoseSet poses = PartsMesh().poses(3);
    Progress silent;
    BakeOptions options;
    options.tolerance = 3e-3;
    options.check_count = 12;
    const BakedAsset baked = bake(poses, options, silent);
    CHECK(baked.report.check.mean_error < 3e-3);
    const NormalizedPoses set = normalize(poses);
    const TieSet ties = find_ties(set);
    REQUIRE(baked.report.check.ties.has_value());
    CHECK(baked.report.check.ties->part_count == 4);
    double worst = 0;
    RuntimeBlender blender(baked.bytes, "the test's asset");
    for (const BlendCheck& check : baked.report.check.blends) {
        const Eigen::VectorXf w = check.weights.cast<float>();
        const Shape blend = from_input_units(set, blender.positions(blender.solve({ w[0], w[1], w[2] }, false)));
        const TieDrift drift = measure_drift(ties, set, check.weights, blend);
        CAPTURE(drift.part);
        CAPTURE(weights_text(check.weights));
        CHECK(drift.largest < 0.005);
        worst = std::max(worst, drift.largest);
    }
    CHECK(baked.report.check.ties->blends.drift.largest == doctest::Approx(worst).epsilon(1e-4));
    CHECK(baked.report.certificate.find("drift_of_blends") != std::string::npos);
}

// The table of tests/baker/bake/real_meshes.md: baker_ties --no-skip -tc="study*"
TEST_CASE("study: what the stiffness of ties does" * doctest::skip())
{
    for (const double turn : { 0.8, 0.3 }) {
        PartsMesh mesh;
        mesh.eye_turn = turn;
        const NormalizedPoses set = normalize(mesh.poses(3));
        for (const double stiffness : { 0.001, 0.01, 0.1, 0.3, 1.0, 10.0, 0.0 }) { // 0: as find_ties has it
            TieSet ties = find_ties(set);
            for (Tie& tie : ties.ties)
                if (stiffness > 0) tie.stiffness = stiffness;
            TieSet eye = ties, jacket = ties;
            eye.ties.clear();
            jacket.ties.clear();
            for (const Tie& tie : ties.ties)
                if (tie.part == 1 || tie.part == 2) (tie.part == 1 ? eye : jacket).ties.push_back(tie);
            const auto energy = tie_parts(std::make_unique<DiscreteShells>(set, ShellOptions()), std::move(ties));
            NewtonSolver solver(*energy, set, default_solver());
            int steps = 0;
            double eye_drift = 0, jacket_drift = 0;
            for (const Eigen::Vector3d& w : { Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(0, 1, 1), Eigen::Vector3d(1, 0, 1),
                                              Eigen::Vector3d(1, 1, 1) }) {
                const NewtonResult result = solver.minimize(w / w.sum(), set.shapes[0], NewtonOptions());
                steps += result.iterations;
                eye_drift = std::max(eye_drift, measure_drift(eye, set, w, result.y).largest);
                jacket_drift = std::max(jacket_drift, measure_drift(jacket, set, w, result.y).largest);
            }
            MESSAGE("turn " << turn << " kappa " << stiffness << ": " << steps << " steps, eye " << 100 * eye_drift
                            << " %, jacket " << 100 * jacket_drift << " %");
        }
    }
}
