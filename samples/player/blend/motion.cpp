#include "blend/motion.h"

#include <algorithm>

namespace pliant::player {
namespace {

constexpr double travel_seconds = 0.9;

} // namespace

Motion::Motion(const ControlPolygon& polygon, glm::dvec2 point, bool plays)
    : polygon_(polygon)
    , point_(point)
{
    if (plays) start_path();
}

void Motion::drag_to(glm::dvec2 point)
{
    state_ = State::rest;
    point_ = polygon_.nearest_inside(point);
}

void Motion::go_to(std::uint32_t corner) { travel_to(polygon_.corners()[corner], false); }

void Motion::toggle_play()
{
    if (plays()) {
        state_ = State::rest;
    } else {
        start_path();
    }
}

void Motion::travel_to(glm::dvec2 target, bool path_follows)
{
    state_ = State::travel;
    from_ = point_;
    target_ = target;
    travelled_ = 0.0;
    path_follows_ = path_follows;
}

void Motion::start_path()
{
    phase_ = polygon_.idle_phase_near(point_);
    travel_to(polygon_.idle_point(phase_), true);
}

void Motion::advance(double seconds)
{
    if (state_ == State::travel) {
        travelled_ = std::min(travelled_ + seconds, travel_seconds);
        const double s = travelled_ / travel_seconds;
        point_ = from_ + (s * s * (3.0 - 2.0 * s)) * (target_ - from_);
        if (travelled_ >= travel_seconds) state_ = path_follows_ ? State::path : State::rest;
    } else if (state_ == State::path) {
        phase_ += seconds / (seconds_per_edge * polygon_.corner_count());
        point_ = polygon_.idle_point(phase_);
    }
}

} // namespace pliant::player
