#include "anatomy.h"

#include <algorithm>
#include <cmath>

namespace pliant::creature {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

const Axis spine_axis;

Axis moved(Axis axis, const Vec3& origin)
{
    axis.origin = origin;
    return axis;
}

// An axis from `origin` along `tangent` with an up direction close to `up` and a side direction on the side of `side`;
// its frame may be left-handed.
Axis axis_towards(const Vec3& origin, const Vec3& tangent, const Vec3& side, const Vec3& up)
{
    Axis axis;
    axis.origin = origin;
    axis.tangent = tangent.normalized();
    axis.up = (up - up.dot(axis.tangent) * axis.tangent).normalized();
    axis.side = axis.up.cross(axis.tangent);
    if (axis.side.dot(side) < 0.0) axis.side = -axis.side;
    return axis;
}

Shape ball(const Vec3& centre, double radius) { return round_cone(centre, radius, centre + Vec3(1e-6, 0, 0), radius); }

// Spine: tail, trunk, neck. -------------------------------------------------------------------------------------------

const Profile spine_height
    = { { -6.3, 0.09 }, { -5.4, 0.165 }, { -4.2, 0.28 }, { -3.0, 0.39 }, { -2.0, 0.51 }, { -1.2, 0.64 },
        { -0.4, 0.72 }, { 0.5, 0.68 },   { 1.1, 0.55 },  { 1.7, 0.41 },  { 2.4, 0.34 },  { 3.1, 0.36 } };
const Profile spine_width
    = { { -6.3, 0.08 }, { -5.4, 0.115 }, { -4.2, 0.19 }, { -3.0, 0.295 }, { -2.0, 0.46 }, { -1.2, 0.66 },
        { -0.4, 0.78 }, { 0.5, 0.72 },   { 1.1, 0.56 },  { 1.7, 0.4 },    { 2.4, 0.33 },  { 3.1, 0.36 } };

// Rounded plates along the back, shrinking with the body under them.
Shape crest()
{
    std::vector<Shape> plates;
    for (double s = 2.5; s > -6.15;) {
        const double h = spine_height(s);
        const double size = s > 1.0 ? 0.085 + 0.17 * h : 0.09 + 0.21 * h; // lower on the neck, which bends most
        Axis axis = axis_towards(spine_axis.at(s, 0.0, h + 0.1 * size), { 1.0, 0.0, 0.45 }, Vec3::UnitY(), Vec3::UnitZ());
        plates.push_back(ellipsoid(axis, { 1.05 * size, 0.66 * size, 0.9 * size }));
        s -= 2.65 * size;
    }
    return smooth_union(std::move(plates), 0.08);
}

// Head. ---------------------------------------------------------------------------------------------------------------

// The parts of the head are placed relative to this x, on the spine.
const double head_x = 3.55;

Shape head()
{
    std::vector<Shape> shapes;
    shapes.push_back(ellipsoid(moved(spine_axis, { head_x, 0.0, 0.12 }), { 0.74, 0.74, 0.6 }));
    shapes.push_back(ellipsoid(moved(spine_axis, { head_x + 0.6, 0.0, -0.04 }), { 0.62, 0.56, 0.36 }));
    for (double side : { 1.0, -1.0 }) {
        shapes.push_back(ellipsoid(moved(spine_axis, { head_x + 0.2, 0.47 * side, -0.12 }), { 0.38, 0.28, 0.28 })); // cheek
        shapes.push_back(
            ellipsoid(moved(spine_axis, { head_x + 0.97, 0.2 * side, 0.2 }), { 0.17, 0.13, 0.11 })); // nostril rim
        shapes.push_back(ellipsoid(moved(spine_axis, { head_x + 0.13, 0.46 * side, 0.5 }), { 0.34, 0.27, 0.27 })); // brow
    }
    return smooth_union(std::move(shapes), 0.25);
}

// Eyeballs protrude from the brows with a sharp seam, which makes them look like eyes.
Shape eyes()
{
    std::vector<Shape> shapes;
    for (double side : { 1.0, -1.0 }) shapes.push_back(ball({ head_x + 0.28, 0.57 * side, 0.58 }, 0.25));
    return smooth_union(std::move(shapes), 0.02);
}

// The shapes to cut away: mouth line, nostrils, pupils.
Shape face_cuts(const Shape& solid_head)
{
    std::vector<Shape> cuts;
    // The smile: a tube along the head's surface, rising at the corners.
    Vec3 last = Vec3::Zero();
    const int steps = 48;
    for (int i = 0; i <= steps; ++i) {
        const double x = 2.0 * i / steps - 1.0;
        const double angle = 112.0 * degree * x;
        const double lift = -0.14 - 0.03 * std::cos(3.0 * angle) + 0.34 * std::pow(std::abs(x), 4.0);
        const Vec3 start = Vec3(head_x + 0.35, 0.0, 0.0) + Vec3(0.75 * std::cos(angle), 0.6 * std::sin(angle), lift);
        const Vec3 p = project(solid_head, start);
        const double r = 0.045 * std::sqrt(std::max(0.0, 1.0 - x * x)) + 0.015;
        if (i > 0) cuts.push_back(round_cone(last, r, p, r));
        last = p;
    }
    for (double side : { 1.0, -1.0 }) {
        cuts.push_back(ball({ head_x + 1.15, 0.215 * side, 0.235 }, 0.065)); // nostril
        cuts.push_back(
            ball(Vec3(head_x + 0.28, 0.57 * side, 0.58) + 0.4 * Vec3(0.66, 0.7 * side, 0.27).normalized(), 0.215)); // pupil
    }
    return smooth_union(std::move(cuts), 0.01);
}

// Limbs and gills. ----------------------------------------------------------------------------------------------------

struct LimbPlan {
    Profile radius;
    double toe_length, toe_radius, palm_length, palm_width;
};

const LimbPlan arm_plan
    = { { { 0.0, 0.36 }, { 0.7, 0.31 }, { 1.2, 0.235 }, { 1.8, 0.19 }, { 2.2, 0.18 } }, 0.46, 0.095, 0.27, 0.27 };
const LimbPlan leg_plan
    = { { { 0.0, 0.46 }, { 0.7, 0.4 }, { 1.25, 0.27 }, { 1.8, 0.21 }, { 2.2, 0.2 } }, 0.5, 0.105, 0.3, 0.3 };

Shape foot(const Axis& axis, const LimbPlan& plan)
{
    std::vector<Shape> shapes;
    const double ankle = plan.radius.last();
    shapes.push_back(ellipsoid(moved(axis, axis.at(ankle + 0.1)), { plan.palm_length, plan.palm_width, 0.17 }));
    for (double degrees : { -63.0, -21.0, 21.0, 63.0 }) {
        const Vec3 along = axis.direction(std::cos(degrees * degree), std::sin(degrees * degree), 0.0);
        const Vec3 knuckle = axis.at(ankle + 0.12) + 0.1 * along;
        const Vec3 tip = knuckle + (plan.toe_length + (std::abs(degrees) < 30 ? 0.06 : 0.0)) * along - 0.03 * axis.up;
        shapes.push_back(round_cone(knuckle, 1.15 * plan.toe_radius, tip, 0.95 * plan.toe_radius));
        shapes.push_back(ellipsoid(moved(axis, tip), Vec3(1.5, 1.5, 1.1) * plan.toe_radius)); // a gecko's toe pad
    }
    return smooth_union(std::move(shapes), 0.12);
}

Part limb(const std::string& name, const LimbPlan& plan, const Vec3& origin, const Vec3& tangent)
{
    Part part;
    part.name = name;
    part.axis = axis_towards(origin, tangent, Vec3::UnitX(), Vec3::UnitZ());
    part.first = 0.0;
    part.last = plan.radius.last() + 0.8;
    part.shape = smooth_union({ lathe(part.axis, plan.radius, plan.radius), foot(part.axis, plan) }, 0.12);
    return part;
}

Part gill(const std::string& name, const Vec3& origin, const Vec3& tangent, double length)
{
    Part part;
    part.name = name;
    part.axis = axis_towards(origin, tangent, Vec3::UnitX(), Vec3::UnitZ());
    part.first = 0.0;
    part.last = length;
    const Profile radius = { { 0.0, 0.18 }, { 0.5 * length, 0.14 }, { length - 0.09, 0.09 } };
    part.shape = lathe(part.axis, radius, radius);
    return part;
}

void add_pair(std::vector<Part>& parts, Part (*make)(const std::string&, const Vec3&, const Vec3&), const std::string& name,
              const Vec3& origin, const Vec3& tangent)
{
    const Vec3 mirror(1.0, -1.0, 1.0);
    parts.push_back(make(name + ".left", origin, tangent));
    parts.push_back(make(name + ".right", mirror.cwiseProduct(origin), mirror.cwiseProduct(tangent)));
}

Part arm(const std::string& name, const Vec3& origin, const Vec3& tangent) { return limb(name, arm_plan, origin, tangent); }
Part leg(const std::string& name, const Vec3& origin, const Vec3& tangent) { return limb(name, leg_plan, origin, tangent); }
Part long_gill(const std::string& name, const Vec3& origin, const Vec3& tangent)
{
    return gill(name, origin, tangent, 1.25);
}
Part short_gill(const std::string& name, const Vec3& origin, const Vec3& tangent)
{
    return gill(name, origin, tangent, 1.1);
}

} // namespace

Anatomy build_anatomy()
{
    Anatomy anatomy;
    auto& parts = anatomy.parts;
    const Shape solid_head = head();
    parts.push_back({ "spine", spine_axis, -6.4, 4.9, {} });
    add_pair(parts, arm, "arm", { 0.85, 0.0, -0.12 }, { 0.12, 1.0, -0.12 });
    add_pair(parts, leg, "leg", { -1.1, 0.0, -0.14 }, { -0.12, 1.0, -0.12 });
    add_pair(parts, short_gill, "gill.top", { head_x - 0.3, 0.36, 0.42 }, { -0.55, 0.5, 0.7 });
    add_pair(parts, long_gill, "gill.middle", { head_x - 0.35, 0.42, 0.15 }, { -0.6, 0.85, 0.2 });
    add_pair(parts, short_gill, "gill.bottom", { head_x - 0.3, 0.42, -0.1 }, { -0.6, 0.75, -0.25 });

    const Shape trunk = smooth_union({ lathe(spine_axis, spine_width, spine_height), crest() }, 0.15);
    Shape spine = smooth_union({ smooth_union({ trunk, solid_head }, 0.35), eyes() }, 0.035);
    std::vector<Shape> limbs { spine }, all;
    for (std::size_t i = 1; i < 5; ++i) limbs.push_back(parts[i].shape);
    all.push_back(smooth_union(std::move(limbs), 0.3));
    for (std::size_t i = 5; i < parts.size(); ++i) all.push_back(parts[i].shape);
    anatomy.skin = smooth_difference(smooth_union(std::move(all), 0.16), face_cuts(solid_head), 0.04);
    parts[0].shape = std::move(spine);

    anatomy.sizing = [](const Vec3& p) {
        const auto ramp = [](double from, double to, double x) { return std::clamp((x - from) / (to - from), 0.0, 1.0); };
        const double face = 0.4 * ramp(head_x - 2.0, head_x + 0.15, p.x()), limb = 0.25 * ramp(0.5, 1.7, std::abs(p.y()));
        const double tail = 0.3 * ramp(-3.5, -5.5, p.x());
        const double gill = 0.35 * ramp(0.7, 1.1, std::abs(p.y())) * ramp(1.7, 2.3, p.x());
        const double crest = 0.3 * ramp(0.3, 0.1, std::abs(p.y())) * ramp(0.0, 0.1, p.z() - 0.85 * spine_height(p.x()));
        return 1.0 - std::max({ face, limb, tail, gill, crest });
    };
    anatomy.box_min = { -6.8, -3.6, -1.2 };
    anatomy.box_max = { 5.3, 3.6, 1.6 };
    return anatomy;
}

} // namespace pliant::creature
