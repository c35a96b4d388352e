#include "blend/frame_times.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pliant::player {

void FrameTimes::add(const FrameTime& time)
{
    times_[added_ % capacity] = time;
    ++added_;
}

std::size_t FrameTimes::count() const { return std::min(added_, capacity); }

FrameTime FrameTimes::median() const
{
    FrameTime result;
    if (count() == 0) return result;
    for (double FrameTime::*part : { &FrameTime::solve, &FrameTime::reconstruct, &FrameTime::draw }) {
        std::vector<double> values;
        for (std::size_t i = 0; i < count(); ++i) values.push_back(times_[i].*part);
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        result.*part = *middle;
    }
    return result;
}

double FrameTimes::longest() const
{
    double longest = 0.0;
    for (std::size_t i = 0; i < count(); ++i) longest = std::max(longest, times_[i].sum());
    return longest;
}

double axis_end(double longest)
{
    if (!(longest > 0.0)) return 1.0;
    const double power = std::pow(10.0, std::floor(std::log10(longest)));
    for (double step : { 1.0, 2.0, 5.0 })
        if (longest <= step * power) return step * power;
    return 10.0 * power;
}

} // namespace pliant::player
