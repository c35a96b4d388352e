// How the point in the control polygon moves: along the idle path, by hand, or travelling to a corner. No graphics in here.
#pragma once

#include "blend/control_polygon.h"

namespace pliant::player {

// How long the idle path takes from one corner to the next.
constexpr double seconds_per_edge = 2.8;

class Motion {
public:
    // Starts at `point`; plays: whether it sets out along the idle path.
    Motion(const ControlPolygon& polygon, glm::dvec2 point, bool plays);

    // The user takes over: puts the point somewhere, sends it to a corner, or stops and starts the path.
    void drag_to(glm::dvec2 point);
    void go_to(std::uint32_t corner);
    void toggle_play();

    // Moves on by so many seconds.
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
