#include "cli/certificate_lines.h"

#include <fmt/format.h>

namespace pliant {

std::string verdict_of(const CertificateFacts& facts)
{
    if (!facts.is_readable || !facts.mean_error) return "no errors were measured when it was baked";
    return fmt::format(
        "{} its tolerance: blends at {} weights are off by {:.2e} (mean, allowed {:g}) and {:.2e} (largest{})",
        facts.meets_tolerance.value_or(false) ? "keeps" : "misses", facts.checks.size(), *facts.mean_error, facts.tolerance,
        facts.largest_error.value_or(0), facts.tolerance_max > 0 ? fmt::format(", allowed {:g}", facts.tolerance_max) : "");
}

std::string drift_line(const CertificateFacts& facts)
{
    return facts.largest_drift ? fmt::format("parts drift by at most {:.2f} % of the diagonal", 100 * *facts.largest_drift)
                               : "";
}

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
