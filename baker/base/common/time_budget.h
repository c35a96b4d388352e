// A limit of time for work that can stop early.
#pragma once

#include <chrono>
#include <optional>

namespace pliant {

// Shares of a bake's time, if that is limited, at which its stages stop refining.
constexpr double snapshot_share = 0.4, check_share = 0.5, fit_share = 0.85, fresh_share = 0.95;

class TimeBudget {
public:
    // The clock starts here. Without seconds there is no limit; 0 seconds are spent at once, on any machine.
    explicit TimeBudget(std::optional<double> seconds = {})
        : seconds_(seconds)
    {
    }

    bool has_limit() const { return seconds_.has_value(); }

    // Whether this share of the time will be spent in so many seconds from now.
    bool is_spent(double share = 1, double ahead = 0) const { return seconds_ && elapsed() + ahead >= share * *seconds_; }

    double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::optional<double> seconds_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace pliant
