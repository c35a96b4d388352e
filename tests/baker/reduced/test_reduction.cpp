// Subspaces, cubature, ghosts, predictors: the stages between the energies and the asset.
#include "../train.h"
#include "../tube.h"

#include "bake/bake.h"
#include "bake/make_energy.h"
#include "base/weights/radial_function.h"
#include "base/weights/sampling.h"
#include "elastic/average/rigid_modes.h"
#include "reduced/subspace/krylov.h"
#include "reduced/surrogate/ghost.h"
#include "reduced/surrogate/nnls.h"

#include <Eigen/Dense>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

struct Problem {
    explicit Problem(std::size_t pose_count)
        : set(normalize(tube_poses(pose_count)))
        , energy(set, ShellOptions())
        , solver(energy, set, default_solver())
    {
    }
    NormalizedPoses set;
    DiscreteShells energy;
    NewtonSolver solver;
};

} // namespace

TEST_CASE("normalised poses have unit mean area, unit mass, and meet pose 0")
{
    PoseSet poses = tube_poses(3);
    // Pose 1 moved away and turned: alignment must bring it back.
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    PoseSet moved = poses;
    moved.positions[1] = ((poses.positions[1] * turn.transpose()).rowwise() + Eigen::RowVector3d(100, -20, 3)).eval();
    const NormalizedPoses a = normalize(poses), b = normalize(moved);
    CHECK(a.masses.sum() == doctest::Approx(1));
    double area = 0;
    for (const Shape& s : a.shapes) area += triangle_areas(s, a.triangles).sum() / 3;
    CHECK(area == doctest::Approx(1));
    CHECK((a.shapes[1] - b.shapes[1]).norm() < 1e-12 * a.shapes[1].norm() * 100);
    const Positions back = to_input_units(a, a.shapes[0]);
    CHECK((back - poses.positions[0]).norm() < 1e-12 * back.norm());
    for (std::size_t k = 0; k < 3; ++k) {
        // Best alignment puts all centroids at the same place; the motions that are reported lead there.
        const Eigen::Map<const Positions> rows(a.shapes[k].data(), a.masses.size(), 3);
        CHECK((rows.transpose() * a.masses).norm() < 1e-7); // the origin is rounded to single precision
        Shape x = Eigen::Map<const Shape>(poses.positions[k].data(), a.shapes[k].size());
        apply(a.motions[k], x);
        const Positions placed = to_input_units(a, a.shapes[k]);
        CHECK((x - Eigen::Map<const Shape>(placed.data(), x.size())).norm() < 1e-12 * x.norm());
    }
}

TEST_CASE("a subspace is mass-orthonormal and holds the poses exactly")
{
    Problem p(3);
    const Subspace subspace = build_krylov_subspace(p.solver, { 2, 0, 256 }, nullptr);
    CHECK(subspace.dimension() == 2 + 6 * 3);
    const Eigen::MatrixXd gram = subspace.basis.transpose() * times_mass(subspace.basis, p.set.masses);
    CHECK((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).norm() < 1e-12);
    for (Eigen::Index k = 0; k < 3; ++k)
        CHECK((subspace.shape(subspace.pose_coordinates.col(k)) - p.set.shapes[std::size_t(k)]).norm() < 1e-12);
}

TEST_CASE("a wanted dimension is met exactly, with the differences kept")
{
    Problem p(3);
    for (Eigen::Index d : { 3, 8, 9, 15 }) {
        const Subspace subspace = build_krylov_subspace(p.solver, { 0, d, 256 }, nullptr);
        CHECK(subspace.dimension() == d);
        CHECK((subspace.shape(subspace.pose_coordinates.col(2)) - p.set.shapes[2]).norm() < 1e-12);
    }
}

TEST_CASE("tangents of the curve of averages equal finite differences (paper, equation 6)")
{
    Problem p(2);
    NewtonOptions tight;
    tight.decrement = 1e-22; // the difference of two averages a millionth apart needs all digits
    const double step = 1e-4;
    Weights w(2), direction(2);
    w << 1 - step, step;
    direction << -1, 1;
    Shape moved = p.solver.minimize(w, p.set.shapes[0], tight).y;
    apply(best_rigid_motion(moved, p.set.shapes[0], p.set.masses), moved);
    const Shape tangent = p.solver.weight_derivatives(corner_weights(2, 0), p.set.shapes[0], direction, false);
    const Shape difference = (moved - p.set.shapes[0]) / step;
    CHECK((tangent - difference).norm() < 2e-3 * tangent.norm()); // first order in the step
}

TEST_CASE("CHOLMOD and Eigen find the same average")
{
    if (!has_cholmod()) return;
    Problem p(3);
    NewtonSolver other(p.energy, p.set, SolverKind::eigen);
    NewtonOptions tight;
    tight.decrement = 1e-12;
    const Weights w = equal_weights(3);
    const NewtonResult a = p.solver.minimize(w, p.set.shapes[0], tight), b = other.minimize(w, p.set.shapes[0], tight);
    CHECK(a.has_converged);
    CHECK(b.has_converged);
    CHECK((a.y - b.y).norm() < 1e-7 * a.y.norm());
}

TEST_CASE("non-negative least squares satisfies its optimality conditions and equals the unconstrained solution where that "
          "is positive")
{
    Random random(5);
    Eigen::MatrixXd a(30, 8);
    for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = random.normal();
    const Eigen::VectorXd positive = Eigen::VectorXd::LinSpaced(8, 0.5, 2);
    CHECK((nnls(a.transpose() * a, a.transpose() * (a * positive)) - positive).norm() < 1e-7);
    Eigen::VectorXd b(30);
    for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = random.normal();
    const Eigen::VectorXd x = nnls(a.transpose() * a, a.transpose() * b);
    const Eigen::VectorXd descent = a.transpose() * (b - a * x);
    for (Eigen::Index i = 0; i < 8; ++i) {
        CHECK(x[i] >= 0);
        CHECK(descent[i] < 1e-7);
        if (x[i] > 0) CHECK(std::abs(descent[i]) < 1e-7);
    }
}

TEST_CASE("greedy and thresholding pursuit find the few columns that make up a target, and their weights")
{
    Random random(11);
    Eigen::MatrixXf a(80, 60);
    for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = float(random.normal());
    a.col(7) *= 20; // scale of a column says nothing
    const std::vector<std::size_t> planted = { 3, 7, 21, 40, 58 };
    Eigen::VectorXd b = Eigen::VectorXd::Zero(80);
    for (std::size_t column : planted) b += (column == 7 ? 0.05 : 1) * a.col(Eigen::Index(column)).cast<double>();
    for (const auto& solve : { greedy_nnls, nn_htp }) {
        const SparseFit fit = solve(a, b, 10, {}, [](std::size_t) {});
        CHECK(fit.residual < 1e-5);
        CHECK(fit.columns.size() <= 10);
        CHECK(fit.weights.minCoeff() > 0);
        for (std::size_t column : planted) {
            const auto at = std::find(fit.columns.begin(), fit.columns.end(), column);
            REQUIRE(at != fit.columns.end());
            CHECK(fit.weights[at - fit.columns.begin()] == doctest::Approx(column == 7 ? 0.05 : 1).epsilon(1e-3));
        }
        CHECK(solve(a, -b, 10, {}, [](std::size_t) {}).residual > 0.5); // weights are not negative
    }
}

TEST_CASE("non-negative least squares ends where it began, and greedy stops where no column helps")
{
    Random random(21);
    Eigen::MatrixXf a(60, 400);
    for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = float(random.normal());
    a.row(0).setConstant(0); // out of reach
    Eigen::VectorXd b(60);
    for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = random.normal();
    const Eigen::MatrixXd few = a.leftCols(100).cast<double>(), gram = few.transpose() * few;
    const Eigen::VectorXd right = few.transpose() * b, cold = nnls(gram, right);
    CHECK((nnls(gram, right, Eigen::VectorXd::Zero(100)) - cold).norm() < 1e-6 * cold.norm());
    CHECK((nnls(gram, right, cold) - cold).norm() < 1e-6 * cold.norm());
    // 59 columns at most can be positive at once: asked for more, it must not go on to exchange them.
    int rounds = 0;
    const SparseFit fit = greedy_nnls(a, b, 200, {}, [&](std::size_t) { ++rounds; });
    CHECK(fit.residual == doctest::Approx(std::abs(b[0]) / b.norm()).epsilon(0.05));
    CHECK(rounds < 16);
}

TEST_CASE("with all elements at weight one the surrogate energy is the reduced energy")
{
    Problem p(3);
    const Subspace subspace = build_krylov_subspace(p.solver, { 0, 6, 256 }, nullptr);
    std::vector<std::size_t> all(p.energy.element_count());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    const SurrogateEnergy surrogate(p.energy, subspace.rest, subspace.basis, all,
                                    Eigen::VectorXd::Ones(Eigen::Index(all.size())));
    const ReducedEnergy reduced(p.energy, subspace);
    Weights w(3);
    w << 0.2, 0.5, 0.3;
    const Eigen::VectorXd q = subspace.pose_coordinates * w;
    Eigen::VectorXd g1, g2;
    CHECK(surrogate.gradient(w, q, g1) == doctest::Approx(reduced.gradient(w, q, g2)).epsilon(1e-12));
    CHECK((g1 - g2).norm() < 1e-11 * g2.norm());
    const Eigen::MatrixXd h1 = surrogate.hessian(w, q, HessianKind::exact), h2 = reduced.hessian(w, q, HessianKind::exact);
    CHECK((h1 - h2).norm() < 1e-11 * h2.norm());
}

TEST_CASE("a few elements give the reduced average within a per cent, and the error falls with their number")
{
    Problem p(3);
    const Subspace subspace = build_krylov_subspace(p.solver, { 1, 0, 256 }, nullptr);
    const ReducedEnergy reduced(p.energy, subspace);
    const TrainingSet training = train(p.solver, subspace, 24);
    CHECK(training.unconverged_count == 0);
    const Eigen::MatrixXd metric = training.whitening * training.whitening.transpose();
    CubatureFit fit(reduced, training, CubatureOptions(), nullptr);
    double errors[2];
    for (int i = 0; i < 2; ++i) {
        const std::size_t count = std::size_t(i == 0 ? 3 : 8) * std::size_t(subspace.dimension());
        const SurrogateEnergy surrogate = fit.fit(count);
        CHECK(measure_curvature(surrogate, training).lowest > 0.05);
        CHECK(surrogate.element_count() <= count);
        Weights w(3);
        w << 0.15, 0.6, 0.25;
        MinimizeOptions minimize_options;
        minimize_options.scale = training.energy_scale;
        const auto exact = minimize([&](const Eigen::VectorXd& q, Eigen::VectorXd& g) { return reduced.gradient(w, q, g); },
                                    training.averages[0], metric, minimize_options);
        const auto fast = minimize([&](const Eigen::VectorXd& q, Eigen::VectorXd& g) { return surrogate.gradient(w, q, g); },
                                   training.averages[0], metric, minimize_options);
        CHECK(exact.has_converged);
        CHECK(fast.has_converged);
        errors[i] = (exact.q - fast.q).norm() / mass_norm(subspace.shape(exact.q), p.set.masses);
    }
    CHECK(errors[1] < 1e-2);
    CHECK(errors[1] < errors[0]);
}

TEST_CASE("elements that hardly deform get no weight")
{
    // A tube that bends a little, and a longer one behind it that does not: what its hinges say is rounding, until a weight
    // makes it large.
    PoseSet poses = tube_poses(2);
    poses.positions[1] = poses.positions[0] + 0.003 * (poses.positions[1] - poses.positions[0]);
    const Positions& straight = poses.positions[0];
    const Eigen::RowVector3d size = straight.colwise().maxCoeff() - straight.colwise().minCoeff();
    const Positions still
        = (straight * Eigen::Vector3d(1, 1, 3).asDiagonal()).rowwise() - Eigen::RowVector3d(0, 0, 3.05 * size.z());
    const std::uint32_t first = std::uint32_t(still.rows());
    for (Positions& positions : poses.positions) {
        positions.conservativeResize(2 * first, 3);
        positions.bottomRows(first) = still;
    }
    for (std::size_t f = 0, count = poses.triangles.size(); f < count; ++f) {
        const Triangle t = poses.triangles[f];
        poses.triangles.push_back({ t[0] + first, t[1] + first, t[2] + first });
    }
    const NormalizedPoses set = normalize(poses);
    const auto energy = make_energy(set, EnergyOptions());
    NewtonSolver solver(*energy, set, default_solver());
    const Subspace subspace = build_krylov_subspace(solver, { 1, 0, 256 }, nullptr);
    const ReducedEnergy reduced(*energy, subspace);
    const TrainingSet training = train(solver, subspace, 24);
    for (const CubatureSolver pursuit : { CubatureSolver::nnls, CubatureSolver::nn_htp }) {
        CubatureOptions options;
        options.solver = pursuit;
        CubatureFit fit(reduced, training, options, nullptr);
        const SurrogateEnergy surrogate = fit.fit(std::size_t(16 * subspace.dimension()));
        CHECK(surrogate.element_count() > std::size_t(subspace.dimension()));
        CHECK(surrogate.weights().maxCoeff() < 1e6);
    }
}

TEST_CASE(
    "solver coordinates are whitened for all training weights together, and a loaded model has their averages as minimisers")
{
    Problem p(3);
    const Subspace subspace = build_krylov_subspace(p.solver, { 1, 0, 256 }, nullptr);
    const ReducedEnergy reduced(p.energy, subspace);
    const TrainingSet training = train(p.solver, subspace, 24);
    CubatureFit fit(reduced, training, CubatureOptions(), nullptr);
    const auto surrogate = std::make_shared<const SurrogateEnergy>(fit.fit(std::size_t(8 * subspace.dimension())));
    const BlendModel model = loaded_model(surrogate, training, subspace);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(subspace.dimension(), subspace.dimension());
    for (std::size_t t = 0; t < training.weights.size(); ++t) {
        sum += model.whitening.transpose()
            * surrogate->hessian(training.weights[t], training.averages[t], HessianKind::exact) * model.whitening
            / double(training.weights.size());
        const MinimizeResult average = model.solve(training.weights[t]);
        CHECK((average.q - training.averages[t]).norm() < 1e-5 * training.averages[t].norm());
    }
    CHECK((sum - Eigen::MatrixXd::Identity(sum.rows(), sum.cols())).norm() < 1e-9);
}

TEST_CASE("a ghost keeps a subset of the vertices, in all poses")
{
    Tube fine { 60, 24 };
    const NormalizedPoses set = normalize(tube_poses(2, fine));
    DiscreteShells energy(set, ShellOptions());
    NewtonSolver solver(energy, set, default_solver());
    const Subspace subspace = build_krylov_subspace(solver, { 1, 0, 256 }, nullptr);
    const Ghost ghost = make_ghost(set, subspace, 300);
    CHECK(ghost.vertices.size() == 300);
    for (std::size_t v = 0; v < ghost.vertices.size(); ++v) {
        CHECK((point(ghost.set.shapes[1], std::uint32_t(v)) - point(set.shapes[1], ghost.vertices[v])).norm() == 0);
        CHECK((ghost.basis.middleRows<3>(3 * Eigen::Index(v))
               - subspace.basis.middleRows<3>(3 * Eigen::Index(ghost.vertices[v])))
                  .norm()
              == 0);
    }
    CHECK(DiscreteShells(ghost.set, ShellOptions()).hinge_count() * 2 == ghost.set.triangles.size() * 3); // closed
}

TEST_CASE("a predictor interpolates its data and reproduces linear functions")
{
    Random random(3);
    std::vector<Weights> centres;
    for (int i = 0; i < 30; ++i) centres.push_back(random_weights(random, 4, i % 2 == 0));
    Eigen::MatrixXd slope(5, 4), values(5, 30);
    for (Eigen::Index i = 0; i < slope.size(); ++i) slope.data()[i] = random.normal();
    for (Eigen::Index i = 0; i < 30; ++i) values.col(i) = slope * centres[std::size_t(i)];
    const Weights w = random_weights(random, 4, false);
    CHECK((fit_radial_function(centres, values)(w) - slope * w).norm() < 1e-10);
    for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = random.normal();
    const RadialFunction predictor = fit_radial_function(centres, values);
    for (std::size_t i = 0; i < centres.size(); ++i)
        CHECK((predictor(centres[i]) - values.col(Eigen::Index(i))).norm() < 1e-9);
}

TEST_CASE("the error of a shape does not see rigid motions, and is zero for the truth")
{
    Problem p(2);
    const Weights w = equal_weights(2);
    const Shape reference = p.solver.minimize(w, p.set.shapes[0], NewtonOptions()).y;
    Shape moved = reference;
    apply({ Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()).toRotationMatrix(), { 1, 2, 3 } }, moved);
    const ShapeError error = shape_error(p.energy, p.set, w, moved, reference);
    CHECK(error.relative_l2 < 1e-12);
    CHECK(std::abs(error.energy_excess) < 1e-9);
}

TEST_CASE("a pose that moves one vertex of next to no mass has a direction, one that differs by rounding has none")
{
    NormalizedPoses set = normalize(tube_poses(2));
    set.masses[0] = 1e-14;
    const Eigen::MatrixXd none(set.dof_count(), 0);
    for (const auto& [move, dimension] : { std::pair(1e-3, 1), std::pair(1e-8, 0) }) {
        set.shapes[1] = set.shapes[0];
        set.shapes[1][0] += move;
        CHECK(build_subspace(set, none, 8).dimension() == dimension);
    }
}
