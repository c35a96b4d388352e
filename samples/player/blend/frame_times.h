// The durations of the last frames, by stage.
#pragma once

#include <array>
#include <cstddef>

namespace pliant::player {

// Milliseconds.
struct FrameTime {
    double solve = 0.0;
    double reconstruct = 0.0; // positions and normals
    double draw = 0.0;        // until the graphics driver reports completion

    double sum() const { return solve + reconstruct + draw; }
};

// The last 120 frames.
class FrameTimes {
public:
    static constexpr std::size_t capacity = 120;

    void add(const FrameTime& time);
    std::size_t count() const;
    // age: 0 is the newest; below count().
    const FrameTime& frame(std::size_t age) const { return times_[(added_ - 1 - age) % capacity]; }
    // Of each stage separately; 0 without frames.
    FrameTime median() const;
    double longest() const; // of whole frames

private:
    std::array<FrameTime, capacity> times_ {};
    std::size_t added_ = 0;
};

// The upper end of an axis for values up to `longest`: the next 1, 2 or 5 times a power of ten.
double axis_end(double longest);

} // namespace pliant::player
