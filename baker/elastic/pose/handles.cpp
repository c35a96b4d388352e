#include "elastic/pose/handles.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {

namespace {

constexpr double degrees_of_a_step = 10, length_of_a_step = 0.1;
constexpr double degree = 3.14159265358979323846 / 180;

Eigen::Vector3d moved(const Motion& motion, double time, const Eigen::Vector3d& p)
{
    if (motion.kind == Motion::Kind::move) return p + time * motion.by;
    return motion.pivot + Eigen::AngleAxisd(time * motion.degrees * degree, motion.axis) * (p - motion.pivot);
}

// Points on one line leave a body free to turn about it.
bool are_on_a_line(const Positions& points, double tolerance)
{
    Eigen::RowVector3d axis = Eigen::RowVector3d::Zero();
    for (Eigen::Index i = 1; i < points.rows(); ++i) {
        const Eigen::RowVector3d to = points.row(i) - points.row(0);
        if (to.squaredNorm() > axis.squaredNorm()) axis = to;
    }
    if (!(axis.norm() > tolerance)) return true;
    axis.normalize();
    for (Eigen::Index i = 1; i < points.rows(); ++i) {
        const Eigen::RowVector3d to = points.row(i) - points.row(0);
        if ((to - to.dot(axis) * axis).norm() > tolerance) return false;
    }
    return true;
}

} // namespace

Handles::Handles(const Script& script, const Positions& rest, DiagnosticList& diagnostics)
    : lower_(rest.colwise().minCoeff().transpose())
    , extent_(rest.colwise().maxCoeff().transpose() - lower_)
    , diagonal_(extent_.norm())
    , owners_(std::size_t(rest.rows()), -1)
{
    const std::size_t errors_before = diagnostics.error_count();
    for (std::size_t line = 0; line < script.lines.size(); ++line) add_handle(script, line, rest, diagnostics);
    for (std::size_t v = 0; v < owners_.size(); ++v) {
        if (owners_[v] < 0) continue;
        vertices_.push_back(std::uint32_t(v));
        handle_of_.push_back(std::uint32_t(owners_[v]));
    }
    rest_.resize(Eigen::Index(vertices_.size()), 3);
    for (std::size_t i = 0; i < vertices_.size(); ++i) rest_.row(Eigen::Index(i)) = rest.row(vertices_[i]);
    if (diagnostics.error_count() == errors_before) check_grip(script, diagnostics);
}

void Handles::claim(std::size_t vertex, std::size_t line, Claim& claim)
{
    std::int32_t& owner = owners_[vertex];
    if (owner >= 0 && owner != std::int32_t(line)) ++claim.taken;
    if (owner >= 0) return;
    owner = std::int32_t(line);
    ++claim.count;
}

// Whether a point in input units lies in a box or a sphere.
bool Handles::contains(const Region& region, const Eigen::Vector3d& point) const
{
    const Eigen::Vector3d offset = point - lower_;
    if (region.kind == Region::Kind::sphere)
        return (offset - region.lower.cwiseProduct(extent_)).norm() <= region.radius * diagonal_;
    const Eigen::Vector3d part = offset.cwiseQuotient(extent_.cwiseMax(1e-300)); // a flat body is reported elsewhere
    return (part.array() >= region.lower.array()).all() && (part.array() <= region.upper.array()).all();
}

// Makes a handle of the vertices in the region of one line that no earlier line has.
void Handles::add_handle(const Script& script, std::size_t line, const Positions& rest, DiagnosticList& diagnostics)
{
    const Region& region = script.lines[line].region;
    const std::string where = script.where(script.lines[line]);
    const bool is_list = region.kind == Region::Kind::vertices;
    Claim found;
    for (const std::uint32_t v : region.vertices) {
        if (v < owners_.size())
            claim(v, line, found);
        else
            diagnostics.add(error_at(2812, where, fmt::format("uses vertex {}, the mesh has {}", v, owners_.size()),
                                     "count from 0, in the order of the mesh file"));
    }
    for (Eigen::Index v = 0; v < rest.rows() && !is_list; ++v)
        if (contains(region, rest.row(v).transpose())) claim(std::size_t(v), line, found);
    if (found.count == 0 && found.taken > 0)
        diagnostics.add(error_at(2814, where,
                                 fmt::format("all {} vertices of the region belong to earlier lines", found.taken),
                                 "a vertex belongs to the first line that names it: put the smaller region first"));
    else if (found.count == 0 && !is_list)
        diagnostics.add(error_at(2813, where, "no vertex lies in the region",
                                 "points are fractions of the bounding box of the rest pose, radii of its diagonal"));
    Handle handle { script.lines[line].motions, found.count };
    for (Motion& motion : handle.motions) {
        motion.by *= diagonal_;
        motion.pivot = lower_ + motion.pivot.cwiseProduct(extent_);
    }
    handles_.push_back(std::move(handle));
}

// Enough vertices to hold the body, some left to move, and something that moves.
void Handles::check_grip(const Script& script, DiagnosticList& diagnostics) const
{
    if (script.lines.empty()) return;
    if (vertices_.size() < 3 || are_on_a_line(rest_, 1e-6 * diagonal_))
        diagnostics.add(error_at(2815, script.path,
                                 fmt::format("{} vertices are held or moved{}: the body could still turn", vertices_.size(),
                                             vertices_.size() < 3 ? "" : ", all on a line"),
                                 "let the regions contain three or more that do not lie on a line"));
    else if (vertices_.size() == owners_.size())
        diagnostics.add(error_at(2816, script.path,
                                 fmt::format("all {} vertices are held or moved: none is free to follow", owners_.size()),
                                 "leave the parts that should bend out of the regions"));
    const bool is_moved
        = std::any_of(handles_.begin(), handles_.end(), [](const Handle& handle) { return !handle.motions.empty(); });
    if (!is_moved)
        diagnostics.add(error_at(2817, script.path, "every region is held: the result would be the rest pose",
                                 "move or turn at least one of them"));
}

Positions Handles::at(double time) const
{
    Positions places = rest_;
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
        const Handle& handle = handles_[handle_of_[std::size_t(i)]];
        if (handle.motions.empty()) continue;
        Eigen::Vector3d p = rest_.row(i).transpose();
        for (const Motion& motion : handle.motions) p = moved(motion, time, p);
        places.row(i) = p.transpose();
    }
    return places;
}

int Handles::nominal_steps() const
{
    double steps = 1;
    for (const Handle& handle : handles_) {
        double of_handle = 0;
        for (const Motion& motion : handle.motions)
            of_handle += motion.kind == Motion::Kind::turn ? std::abs(motion.degrees) / degrees_of_a_step
                                                           : motion.by.norm() / (length_of_a_step * diagonal_);
        steps = std::max(steps, std::ceil(of_handle - 1e-9));
    }
    return int(std::min(steps, 1e6));
}

} // namespace pliant
