// Weights of a blend for messages, by the names of its poses.
#pragma once

#include "base/weights/weights.h"

namespace pliant {

// Of averages weights_text(); of layers those that are not zero: "smile=1,blink=0.5".
std::string blend_text(const Weights& w, const std::vector<std::string>& pose_names);

} // namespace pliant
