#include "output/export/grid_mesh.h"

#include "base/common/diagnostics.h"

#include <cmath>
#include <fmt/core.h>

namespace pliant {

namespace {

constexpr int most_steps = 32767, most_normal_steps = 127;

// `more`: about how many times the step would have to grow beyond what these numbers say.
[[noreturn]] void refuse(double error, double steps, double more)
{
    throw Failure(
        ExitCode::usage,
        error_at(5207, "",
                 fmt::format("positions within {:g} of the diagonal need numbers up to {:.0f}, 16 bits end at {}", error,
                             steps, most_steps),
                 fmt::format("use --quantize {:.1g} or more, or leave it out", more * error * steps / most_steps)));
}

// The middle of a box as floats, so that engines have the same.
Eigen::Vector3d middle_of(const Box& box) { return (0.5 * (box.low + box.high)).cast<float>().cast<double>(); }

double most_of(const Eigen::MatrixXd& steps) { return steps.cwiseAbs().maxCoeff(); }

// The largest distance of a vertex over the samples; `left` (3n x (d + 1)) is what rounding took away.
double largest_distance(const Eigen::MatrixXd& left, const Eigen::MatrixXd& features)
{
    constexpr Eigen::Index block = 16; // shapes in memory at a time
    double largest = 0;
    for (Eigen::Index first = 0; first < features.cols(); first += block) {
        const Eigen::MatrixXd moved = left * features.middleCols(first, std::min(block, features.cols() - first));
        const auto vectors = Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, moved.size() / 3);
        largest = std::max(largest, vectors.colwise().squaredNorm().maxCoeff());
    }
    return std::sqrt(largest);
}

Eigen::MatrixXd beside(const Eigen::MatrixXd& deltas, const Eigen::VectorXd& base)
{
    Eigen::MatrixXd all(base.size(), deltas.cols() + 1);
    all << deltas, base;
    return all;
}

// Normals as bytes. Only their directions count, so those of a vertex whose deltas do not fit into [-1, 1] are made shorter;
// its base keeps the length 1, as glTF wants, and its deltas make up for that.
NormalError round_normals(const MorphMesh& mesh, const DrawnSpace& space, const GridRounding& rounding, Integers& rounded)
{
    Eigen::MatrixXd steps = most_normal_steps * beside(mesh.normals.deltas, mesh.normals.base);
    for (Eigen::Index v = 0; v < steps.rows(); v += 3) {
        auto rows = steps.middleRows<3>(v);
        rows *= std::min(1.0, most_normal_steps / rows.leftCols(rows.cols() - 1).cwiseAbs().maxCoeff());
    }
    rounded = rounding.round(steps, most_normal_steps * mesh.normals.base, most_normal_steps);
    const Eigen::MatrixXd back = rounded.cast<double>();
    return normal_error_of({ back.col(back.cols() - 1), back.leftCols(back.cols() - 1) }, mesh, space);
}

} // namespace

Eigen::VectorXd Grid::steps_of(const Eigen::VectorXd& positions) const
{
    const auto points = Eigen::Map<const Eigen::Matrix3Xd>(positions.data(), 3, positions.size() / 3);
    const Eigen::Matrix3Xd steps = (points.colwise() - origin) / step;
    return Eigen::Map<const Eigen::VectorXd>(steps.data(), steps.size());
}

Grid grid_for(const Eigen::VectorXd& positions, double error)
{
    Box box;
    box.include(positions);
    // Half the diagonal of a cell is the farthest that rounding moves a vertex; the last digits of floats are on top.
    const Grid grid { double(float(1.15 * error * box.diagonal())), middle_of(box) };
    const double steps = most_of(grid.steps_of(positions));
    if (!(steps <= most_steps)) refuse(error, steps, 1.5);
    return grid;
}

double round_to(const Grid& grid, Eigen::VectorXd& positions)
{
    Box box;
    box.include(positions);
    const Eigen::VectorXd steps = grid.steps_of(positions);
    positions = steps.array().round();
    return grid.step * largest_distance(steps - positions, Eigen::MatrixXd::Ones(1, 1)) / box.diagonal();
}

GridMesh make_grid_mesh(const MorphMesh& mesh, const DrawnSpace& space, double error)
{
    const GridRounding rounding(mesh.fitted);
    Eigen::MatrixXf samples(mesh.fitted.rows(), mesh.fitted.cols() + mesh.judged.cols() + mesh.frames.cols());
    samples << mesh.fitted, mesh.judged, mesh.frames;
    const Eigen::MatrixXd features = with_one(samples);
    const double allowed = error * mesh.reachable.diagonal();
    Box box = mesh.reachable;
    box.include(mesh.base.cast<double>());
    GridMesh out;
    out.grid = { double(float(2 * allowed)), middle_of(box) };
    for (int round = 0;; ++round) { // the error falls with the step, so that this ends here or in refuse()
        const Eigen::MatrixXd steps
            = beside(mesh.deltas.cast<double>() / out.grid.step, out.grid.steps_of(mesh.base.cast<double>()));
        const double most = std::max(most_of(steps), most_of(out.grid.steps_of(mesh.reachable.corners())));
        if (!(most < most_steps - 1) || round == 100) refuse(error, most, 4);
        out.positions = rounding.round(steps, steps.rightCols<1>(), most_steps);
        const double found = out.grid.step * largest_distance(steps - out.positions.cast<double>(), features);
        out.error = found / mesh.reachable.diagonal();
        if (found <= allowed) break;
        out.grid.step = double(float(out.grid.step * std::min(0.9, 0.97 * allowed / found)));
    }
    if (mesh.normals.base.size()) out.normal_error = round_normals(mesh, space, rounding, out.normals);
    return out;
}

} // namespace pliant
