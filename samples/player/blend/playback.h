// What a window blends now: weights that were given, a path of weights that plays, or the weights of the point. No graphics in here.
#pragma once

#include "blend/motion.h"
#include "blend/weight_path.h"

#include <optional>
#include <vector>

namespace pliant::player {

class Playback {
public:
    // Shows `start` (sum 1) until the point is moved or the path plays. path: plays at once, `fps` rows a second; without one the point
    // sets out along the idle path of the polygon if `plays`.
    Playback(const ControlPolygon& polygon, std::vector<double> start, bool plays, std::optional<WeightPath> path,
             double fps);

    // The user takes over with the point, or stops and starts what plays.
    void drag_to(glm::dvec2 point);
    void go_to(std::uint32_t corner);
    void toggle_play();

    // Moves on by so many seconds.
    void advance(double seconds);

    std::vector<double> weights() const;
    glm::dvec2 point() const;
    bool plays() const { return source_ == Source::path ? path_plays_ : motion_.plays(); }
    // The path's row and how many it has, while it is what is shown; a file's rows count from 0.
    std::optional<double> path_frame() const;
    std::size_t path_count() const { return path_ ? path_->count() : 0; }

private:
    enum class Source { given, path, point };
    void take_over();

    const ControlPolygon& polygon_;
    std::vector<double> given_;
    std::optional<WeightPath> path_;
    double fps_, frame_ = 0.0;
    bool path_plays_;
    Source source_;
    Motion motion_;
};

} // namespace pliant::player
