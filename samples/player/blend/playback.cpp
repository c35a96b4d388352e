#include "blend/playback.h"

#include <cmath>

namespace pliant::player {

Playback::Playback(const ControlPolygon& polygon, std::vector<double> start, bool plays, std::optional<WeightPath> path,
                   double fps)
    : polygon_(polygon)
    , given_(std::move(start))
    , path_(std::move(path))
    , fps_(fps)
    , path_plays_(path_ && plays)
    , source_(!plays      ? Source::given
                  : path_ ? Source::path
                          : Source::point)
    , motion_(polygon, polygon.point(given_), source_ == Source::point)
{
}

// The point continues from where it is shown.
void Playback::take_over()
{
    if (source_ != Source::point) motion_.drag_to(point());
    source_ = Source::point;
}

void Playback::drag_to(glm::dvec2 point)
{
    source_ = Source::point;
    motion_.drag_to(point);
}

void Playback::go_to(std::uint32_t corner)
{
    take_over();
    motion_.go_to(corner);
}

void Playback::toggle_play()
{
    if (!path_) {
        take_over();
        motion_.toggle_play();
    } else if (source_ == Source::path) {
        path_plays_ = !path_plays_;
    } else {
        source_ = Source::path;
        path_plays_ = true;
    }
}

void Playback::show(std::vector<double> weights)
{
    given_ = std::move(weights);
    source_ = Source::given;
}

void Playback::advance(double seconds)
{
    if (source_ == Source::point) {
        motion_.advance(seconds);
    } else if (source_ == Source::path && path_plays_) {
        frame_ = std::fmod(frame_ + seconds * fps_, static_cast<double>(path_->count()));
    }
}

std::vector<double> Playback::weights() const
{
    switch (source_) {
    case Source::given: return given_;
    case Source::path: return path_->at(frame_);
    case Source::point: break;
    }
    return polygon_.weights(motion_.point());
}

glm::dvec2 Playback::point() const { return source_ == Source::point ? motion_.point() : polygon_.point(weights()); }

std::optional<double> Playback::path_frame() const
{
    if (source_ != Source::path) return std::nullopt;
    return frame_;
}

} // namespace pliant::player
