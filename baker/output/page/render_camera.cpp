// How a character is looked at whose axes nobody has told.
#include "output/page/render.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr float degree = 3.14159265f / 180;
constexpr float snap_angle = 15 * degree;
constexpr float margin = 0.03f;                  // of the picture, on each side
constexpr float thinnest = 0.45f, widest = 2.2f; // width over height
constexpr float alike = 1.05f;                   // principal lengths within this ratio say nothing about a direction

// A unit vector across `up`: along the longer principal axis that the shape has there.
Eigen::Vector3f longer_axis(const std::vector<float>& shape, std::size_t vertex_count, int up)
{
    const int i = up == 0 ? 1 : 0, j = up == 2 ? 1 : 2;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
    double count = 0;
    for (std::size_t v = 0; v < vertex_count; ++v) {
        const Eigen::Vector2d p(shape[3 * v + std::size_t(i)], shape[3 * v + std::size_t(j)]);
        if (!p.allFinite()) continue;
        ++count;
        const Eigen::Vector2d off = p - mean; // Welford: no cancellation far from the origin
        mean += off / count;
        moments += off * (p - mean).transpose();
    }
    Eigen::Vector2d axis = Eigen::Vector2d::UnitX();
    if (moments.allFinite() && count > 2) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(0.5 * (moments + moments.transpose()));
        if (solver.eigenvalues()[1] > alike * alike * std::max(solver.eigenvalues()[0], 0.0))
            axis = solver.eigenvectors().col(1);
    }
    for (int k = 0; k < 2; ++k)
        if (std::abs(axis[k]) > std::cos(snap_angle)) axis = Eigen::Vector2d::Unit(k);
    if (axis[std::abs(axis[0]) >= std::abs(axis[1]) ? 0 : 1] < 0) axis = -axis;
    Eigen::Vector3f out = Eigen::Vector3f::Zero();
    out[i] = float(axis[0]);
    out[j] = float(axis[1]);
    return out;
}

Eigen::Matrix3f axes_of(const std::vector<float>& shape, std::size_t vertex_count, const ViewOptions& options)
{
    const int up_index = options.up == UpAxis::x ? 0 : options.up == UpAxis::y ? 1 : 2;
    const Eigen::Vector3f up = Eigen::Vector3f::Unit(up_index);
    const Eigen::Vector3f across = longer_axis(shape, vertex_count, up_index);
    const Eigen::Vector3f towards = across.cross(up);
    const float turn = options.view == View::front ? 0 : options.view == View::side ? 90 * degree : 30 * degree;
    const float tilt = options.view == View::three_quarter ? 12 * degree : 0;
    const Eigen::Vector3f right = std::cos(turn) * across - std::sin(turn) * towards;
    const Eigen::Vector3f level = std::sin(turn) * across + std::cos(turn) * towards;
    Eigen::Matrix3f axes;
    axes.row(0) = right;
    axes.row(1) = std::cos(tilt) * up - std::sin(tilt) * level;
    axes.row(2) = std::sin(tilt) * up + std::cos(tilt) * level;
    return axes;
}

} // namespace

Camera frame_shapes(const std::vector<ShapeView>& shapes, std::size_t vertex_count, const ViewOptions& options)
{
    Camera camera;
    camera.axes = axes_of(*shapes[0], vertex_count, options);
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max()), high = -low;
    for (const ShapeView shape : shapes) {
        for (std::size_t v = 0; v < vertex_count; ++v) {
            const Eigen::Vector3f p = camera.axes * Eigen::Map<const Eigen::Vector3f>(&(*shape)[3 * v]);
            if (!p.allFinite()) continue;
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    if ((low.array() > high.array()).any()) low.setZero(), high.setZero();
    camera.centre = camera.axes.transpose() * (0.5f * low + 0.5f * high);
    const Eigen::Vector3f size = high - low;
    const float longest = std::max(size.x(), size.y());
    const float ratio = size.x() / size.y(); // of shapes beyond single precision not a number
    const float aspect = std::isfinite(ratio) ? std::clamp(ratio, thinnest, widest) : 1.0f;
    camera.width = int(std::lround(float(options.size) * std::min(1.0f, aspect)));
    camera.height = int(std::lround(float(options.size) * std::min(1.0f, 1 / aspect)));
    camera.scale = 1;
    if (longest > 0 && std::isfinite(longest)) {
        const float room = 1 - 2 * margin;
        camera.scale = std::min(size.x() > 0 ? room * float(camera.width) / size.x() : std::numeric_limits<float>::max(),
                                size.y() > 0 ? room * float(camera.height) / size.y() : std::numeric_limits<float>::max());
    }
    return camera;
}

} // namespace pliant
