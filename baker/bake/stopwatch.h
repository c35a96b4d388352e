// Wall-clock time of each stage, for the report.
#pragma once

#include "bake/report.h"

#include <chrono>

namespace pliant {

class Stopwatch {
public:
    void end_stage(const std::string& stage)
    {
        const auto now = std::chrono::steady_clock::now();
        stages_.push_back({ stage, std::chrono::duration<double>(now - last_).count() });
        last_ = now;
    }

    const std::vector<StageTime>& stages() const { return stages_; }

private:
    std::vector<StageTime> stages_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

} // namespace pliant
