#include "field.h"

#include <algorithm>
#include <cmath>

namespace pliant::creature {
namespace {

// Quadratic smooth minimum (Quilez): differs from min(a, b) only where a and b differ by less than `k`.
double smooth_min(double a, double b, double k)
{
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - 0.25 * k * h * h;
}

} // namespace

Profile::Profile(std::initializer_list<std::pair<double, double>> knots)
{
    for (const auto& [s, v] : knots) {
        position_.push_back(s);
        value_.push_back(v);
    }
    slope_.assign(position_.size(), 0.0);
    for (std::size_t i = 1; i + 1 < position_.size(); ++i)
        slope_[i] = (value_[i + 1] - value_[i - 1]) / (position_[i + 1] - position_[i - 1]);
}

double Profile::operator()(double s) const
{
    if (s <= position_.front()) return value_.front();
    if (s >= position_.back()) return value_.back();
    std::size_t i = 0;
    while (position_[i + 1] < s) ++i;
    const double h = position_[i + 1] - position_[i];
    const double x = (s - position_[i]) / h, y = 1.0 - x;
    return y * y * (1.0 + 2.0 * x) * value_[i] + x * x * (1.0 + 2.0 * y) * value_[i + 1]
        + h * x * y * (y * slope_[i] - x * slope_[i + 1]);
}

double Profile::largest() const { return *std::max_element(value_.begin(), value_.end()); }

Vec3 Axis::local(const Vec3& p) const
{
    const Vec3 d = p - origin;
    return { d.dot(tangent), d.dot(side), d.dot(up) };
}

Shape lathe(const Axis& axis, const Profile& width, const Profile& height)
{
    const double middle = 0.5 * (width.first() + width.last()), half = 0.5 * (width.last() - width.first());
    Shape shape;
    shape.centre = axis.at(middle);
    // With some slack, because splines may overshoot their knots.
    shape.radius = 1.05 * (half + std::max(width.largest(), height.largest()));
    shape.distance = [=](const Vec3& p) {
        const Vec3 l = axis.local(p);
        const double s = std::clamp(l.x(), width.first(), width.last());
        const double w = width(s), h = height(s), r = std::min(w, h);
        return r * (Vec3((l.x() - s) / r, l.y() / w, l.z() / h).norm() - 1.0);
    };
    return shape;
}

Shape ellipsoid(const Axis& axis, const Vec3& semi_axes)
{
    Shape shape;
    shape.centre = axis.origin;
    shape.radius = semi_axes.maxCoeff();
    shape.distance = [=](const Vec3& p) {
        const Vec3 scaled = axis.local(p).cwiseQuotient(semi_axes);
        const double level = scaled.norm(), slope = scaled.cwiseQuotient(semi_axes).norm();
        // First-order distance to the level set; at the very centre both norms vanish.
        return slope > 0.0 ? level * (level - 1.0) / slope : -semi_axes.minCoeff();
    };
    return shape;
}

Shape round_cone(const Vec3& a, double radius_a, const Vec3& b, double radius_b)
{
    Shape shape;
    shape.centre = 0.5 * (a + b);
    shape.radius = 0.5 * (b - a).norm() + std::max(radius_a, radius_b);
    shape.distance = [=](const Vec3& p) {
        const Vec3 d = b - a;
        const double x = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
        return (p - a - x * d).norm() - (radius_a + x * (radius_b - radius_a));
    };
    return shape;
}

Shape smooth_union(std::vector<Shape> shapes, double fillet)
{
    Shape shape;
    for (const Shape& part : shapes) shape.centre += part.centre / double(shapes.size());
    for (const Shape& part : shapes)
        shape.radius = std::max(shape.radius, (part.centre - shape.centre).norm() + part.radius);
    shape.radius += fillet;
    shape.distance = [shapes = std::move(shapes), fillet](const Vec3& p) {
        double d = shapes.front().distance(p);
        for (std::size_t i = 1; i < shapes.size(); ++i)
            if (shapes[i].lower_bound(p) < d + fillet) d = smooth_min(d, shapes[i].distance(p), fillet);
        return d;
    };
    return shape;
}

Shape smooth_difference(Shape body, Shape tool, double fillet)
{
    Shape shape;
    shape.centre = body.centre;
    shape.radius = body.radius;
    shape.distance = [body = std::move(body), tool = std::move(tool), fillet](const Vec3& p) {
        const double d = body.distance(p);
        return tool.lower_bound(p) < fillet - d ? -smooth_min(-d, tool.distance(p), fillet) : d;
    };
    return shape;
}

Vec3 gradient(const Shape& shape, const Vec3& p)
{
    // A thousandth of the smallest feature: far above the rounding error (1e-16 / 1e-4), far below any radius of curvature.
    const double h = 1e-4;
    Vec3 g;
    for (int i = 0; i < 3; ++i) {
        const Vec3 step = h * Vec3::Unit(i);
        g[i] = (shape.distance(p + step) - shape.distance(p - step)) / (2.0 * h);
    }
    return g;
}

Vec3 project(const Shape& shape, Vec3 p)
{
    for (int i = 0; i < 3; ++i) {
        const double d = shape.distance(p);
        // Three digits finer than float32 resolves in a body of ten units.
        if (std::abs(d) < 1e-9) break;
        const Vec3 g = gradient(shape, p);
        // The gradient of a scaled ellipsoid may be shorter than 1; the bound keeps a step near the surface.
        const double step = d / std::max(g.squaredNorm(), 0.1);
        p -= step * g;
    }
    return p;
}

} // namespace pliant::creature
