// A limit of time for work that can stop early.
#pragma once

#include <chrono>
#include <optional>

namespace pliant {

class TimeBudget {
public:
    // The clock starts here. Without seconds there is no limit; 0 seconds are spent at once, on any machine.
    explicit TimeBudget(std::optional<double> seconds = {})
        : seconds_(seconds)
    {
    }

    bool has_limit() const { return seconds_.has_value(); }

    // The first part of the time, from the same start: this share of it.
    TimeBudget part(double share) const
    {
        TimeBudget out = *this;
        if (seconds_) out.seconds_ = share * *seconds_;
        return out;
    }

    // Whether the time is over, or will be in so many seconds.
    bool is_spent(double ahead = 0) const { return seconds_ && elapsed() + ahead >= *seconds_; }

    double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::optional<double> seconds_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace pliant
