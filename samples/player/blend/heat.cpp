#include "blend/heat.h"

#include "blend/alignment.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::player {

HeatColours linear_heat_colours()
{
    HeatColours colours = heat_colours;
    for (glm::vec3& colour : colours)
        for (int i = 0; i < 3; ++i) colour[i] = std::pow(colour[i], 2.2f);
    return colours;
}

float heat_of_share(float share)
{
    if (!(share > lowest_heat)) return 0.0f;
    return std::min(std::log(share / lowest_heat) / std::log(highest_heat / lowest_heat), 1.0f);
}

HeatSummary measure_heat(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b, std::size_t count, float diagonal,
                         std::vector<float>& heat)
{
    HeatSummary summary;
    double sum = 0.0;
    std::fill(heat.begin(), heat.end(), 0.0f);
    const RigidMotion motion = best_motion(a, b, count);
    for (std::size_t v = 0; v < count; ++v) {
        const float share = static_cast<float>(glm::distance(motion(a[v]), glm::dvec3(b[v]))) / diagonal;
        heat[v] = heat_of_share(share);
        sum += share;
        summary.largest = std::max(summary.largest, share);
    }
    if (count > 0) summary.mean = static_cast<float>(sum / static_cast<double>(count));
    return summary;
}

float diagonal_of(const std::vector<glm::vec3>& positions, std::size_t count)
{
    glm::vec3 lowest(std::numeric_limits<float>::max()), highest(std::numeric_limits<float>::lowest());
    for (std::size_t v = 0; v < count; ++v) {
        lowest = glm::min(lowest, positions[v]);
        highest = glm::max(highest, positions[v]);
    }
    return std::max(glm::distance(lowest, highest), 1e-30f); // callers divide by it, also for a shape of zero size
}

} // namespace pliant::player
