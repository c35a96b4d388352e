#include "cli/kind_line.h"

#include <fmt/format.h>

namespace pliant {

std::string kind_line(const KindErrors& kind)
{
    std::string line = fmt::format("{}: {} {}", kind.kind, kind.count, kind.count == 1 ? "mixture" : "mixtures");
    if (kind.count)
        line += fmt::format(", relative L2 {:.2e} (mean), {:.2e} (largest); linear sum {:.2e} and {:.2e}", kind.mean,
                            kind.largest, kind.linear_mean, kind.linear_largest);
    if (kind.lost_count) line += fmt::format("; {} more had no shape to compare with", kind.lost_count);
    return line;
}

} // namespace pliant
