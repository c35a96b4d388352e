// Moves the point in the control polygon: along the idle path, by hand, or to a corner.
#pragma once

#include "blend/control_polygon.h"

namespace pliant::player {

// Duration of the idle path from one corner to the next.
constexpr double seconds_per_edge = 2.8;

class Motion {
public:
    // Starts at `point`; plays: whether to start along the idle path.
    Motion(const ControlPolygon& polygon, glm::dvec2 point, bool plays);

    // User input: places the point, sends it to a corner, or starts and stops the path.
    void drag_to(glm::dvec2 point);
    void go_to(std::uint32_t corner);
    void toggle_play();

    // Advances the motion by a time step.
    void advance(double seconds);

    glm::dvec2 point() const { return point_; }
    bool plays() const { return state_ == State::path || (state_ == State::travel && path_follows_); }

private:
    enum class State { rest, travel, path };
    void travel_to(glm::dvec2 target, bool path_follows);
    void start_path();

    const ControlPolygon& polygon_;
    State state_ = State::rest;
    glm::dvec2 point_, from_ { 0.0 }, target_ { 0.0 };
    double travelled_ = 0.0; // seconds
    double phase_ = 0.0;
    bool path_follows_ = false;
};

} // namespace pliant::player
