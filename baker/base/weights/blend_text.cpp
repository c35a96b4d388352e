#include "base/weights/blend_text.h"

#include <fmt/format.h>

namespace pliant {

std::string blend_text(const Weights& w, const std::vector<std::string>& pose_names)
{
    if (std::size_t(w.size()) + 1 != pose_names.size()) return weights_text(w);
    std::string text;
    for (Eigen::Index k = 0; k < w.size(); ++k)
        if (w[k] != 0) text += fmt::format("{}{}={:.3g}", text.empty() ? "" : ",", pose_names[std::size_t(k) + 1], w[k]);
    return text.empty() ? "0" : text;
}

} // namespace pliant
