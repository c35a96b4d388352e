// What is on the screen: which blends, at which weights, and how far apart they are.
#pragma once

#include "blend/character.h"
#include "blend/heat.h"

#include <optional>
#include <string>
#include <vector>

namespace pliant::player {

// both: linear beside elastic; three: these beside the unreduced average.
enum class Show { elastic, linear, both, three };

struct Shown {
    Show show = Show::elastic;
    bool heat = false;
    std::vector<double>
        weights;       // of every blend: those asked for or, with unreduced averages at hand, the nearest of theirs
    BlendCost cost {}; // of the elastic blend if there is one, else of the linear one
    std::optional<std::size_t> truth;            // number of the unreduced average
    HeatSummary linear_heat {}, elastic_heat {}; // with `heat`: distances from the truth, without a truth from each other
};

// Which characters stand side by side, from the left.
enum class Kind { linear, elastic, unreduced };
std::vector<Kind> kinds_of(Show show);
const char* name_of(Kind kind);

} // namespace pliant::player
