// Implicit shapes: functions that are negative inside, positive outside and approximate the signed distance.
#pragma once

#include "types.h"

#include <functional>
#include <utility>

namespace pliant::creature {

// A shape and its bounding ball, with which a query skips distant shapes.
struct Shape {
    std::function<double(const Vec3&)> distance;
    Vec3 centre = Vec3::Zero();
    double radius = 0.0;

    // A lower bound of `distance(p)`, at the cost of one square root.
    double lower_bound(const Vec3& p) const { return (p - centre).norm() - radius; }
};

// A smooth function of one variable through given knots: a cubic Hermite spline with Catmull-Rom slopes, zero slope at both
// ends, and constant beyond them. Knots are pairs (position, value) with increasing positions.
class Profile {
public:
    Profile(std::initializer_list<std::pair<double, double>> knots);
    double operator()(double s) const;
    double first() const { return position_.front(); }
    double last() const { return position_.back(); }
    double largest() const;

private:
    std::vector<double> position_, value_, slope_;
};

// A straight line with an orthonormal frame: `tangent` along it, `side` and `up` across. The frame may be left-handed,
// because the right limbs are mirror images of the left ones.
struct Axis {
    Vec3 origin = Vec3::Zero();
    Vec3 tangent = Vec3::UnitX(), side = Vec3::UnitY(), up = Vec3::UnitZ();

    Vec3 at(double s, double a = 0.0, double b = 0.0) const { return origin + s * tangent + a * side + b * up; }
    Vec3 direction(double s, double a, double b) const { return s * tangent + a * side + b * up; }
    Vec3 local(const Vec3& p) const;
};

// A body around an axis with elliptic cross-sections: `width(s)` and `height(s)` are the semi-axes along side and up. Its
// ends, at the first and last knot, are rounded.
Shape lathe(const Axis& axis, const Profile& width, const Profile& height);

// An ellipsoid with the given semi-axes along tangent, side and up of `axis`, centred at its origin.
Shape ellipsoid(const Axis& axis, const Vec3& semi_axes);

// The convex hull of two balls.
Shape round_cone(const Vec3& a, double radius_a, const Vec3& b, double radius_b);

// The union of shapes with fillets of about `fillet` width along the seams. Each shape is joined to the union of the earlier
// ones; the fillets depend slightly on the order.
Shape smooth_union(std::vector<Shape> shapes, double fillet);

// `body` minus `tool`, with a rounded rim.
Shape smooth_difference(Shape body, Shape tool, double fillet);

// The gradient by central differences.
Vec3 gradient(const Shape& shape, const Vec3& p);

// Projects a point near the surface onto it, by Newton steps along the gradient.
Vec3 project(const Shape& shape, Vec3 p);

} // namespace pliant::creature
