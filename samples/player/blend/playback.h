// Chooses the weights that a window blends: given weights, a path of weights, or the weights of the point.
#pragma once

#include "blend/motion.h"
#include "blend/weight_path.h"

#include <optional>
#include <vector>

namespace pliant::player {

class Playback {
public:
    // Shows `start` until the point is moved, other weights are given or the path plays. If `plays`, the path plays at once,
    // `fps` rows per second, or without a path the point starts along the polygon's idle path.
    Playback(const ControlPolygon& polygon, std::vector<double> start, bool plays, std::optional<WeightPath> path,
             double fps);

    // User input: moves the point, or starts and stops the playback.
    void drag_to(glm::dvec2 point);
    void go_to(std::uint32_t corner);
    void toggle_play();
    // Shows weights until the point is moved or the path plays.
    void show(std::vector<double> weights);

    // Advances the playback by a time step.
    void advance(double seconds);

    std::vector<double> weights() const;
    glm::dvec2 point() const;
    bool plays() const { return source_ == Source::path ? path_plays_ : motion_.plays(); }
    // While the path is shown: the current row, counted from 0. path_count(): the number of rows.
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
