// The state on the screen: kinds of blend, weights, cost and distances.
#pragma once

#include "blend/character.h"
#include "blend/heat.h"

#include <optional>
#include <string>
#include <vector>

namespace pliant::player {

// both: linear beside elastic. three: linear, elastic and the unreduced average.
enum class Show { elastic, linear, both, three };

struct Shown {
    Show show = Show::elastic;
    bool heat = false;
    std::vector<double> weights;                 // as requested or, with unreduced averages, the nearest of theirs
    BlendCost cost {};                           // of the elastic blend if it is shown, else of the linear one
    std::optional<std::size_t> truth;            // index of the unreduced average
    HeatSummary linear_heat {}, elastic_heat {}; // with `heat`: distances from the truth or, without one, from each other
};

// The characters side by side, from left to right.
enum class Kind { linear, elastic, unreduced };
std::vector<Kind> kinds_of(Show show);
const char* name_of(Kind kind);

} // namespace pliant::player
