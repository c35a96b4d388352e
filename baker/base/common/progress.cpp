#include "base/common/progress.h"

#include <algorithm>

namespace pliant {

// Of the way left, that a round of a PlannedStage takes.
static constexpr double round_share = 0.35;

void Progress::update(const std::string&, double, const std::string&) {}
void Progress::warn(int, const std::string&, const std::string&) {}

void SharedProgress::describe(const std::string& stage, double fraction, const std::string& detail)
{
    stage_ = stage;
    fraction_ = fraction;
    detail_ = detail;
    update(stage, fraction, detail);
}

void SharedProgress::update(const std::string& stage, double fraction, const std::string& detail)
{
    if (std::this_thread::get_id() != owner_) {
        if (is_interrupted_) throw Interrupted();
        return;
    }
    if (!target_) return;
    try {
        if (stage_.empty())
            target_->update(stage, fraction, detail);
        else
            target_->update(stage_, fraction_, detail_);
    } catch (const Interrupted&) {
        is_interrupted_ = true;
        throw;
    }
}

void PlannedProgress::start_round()
{
    from_ = std::max(from_, done_);
    to_ = stage_->has_rounds ? from_ + round_share * (stage_->end - from_) : stage_->end;
    last_ = 0;
}

void PlannedProgress::enter(const std::string& stage)
{
    name_ = stage;
    const auto found
        = std::find_if(plan_.begin(), plan_.end(), [&](const PlannedStage& planned) { return planned.name == stage; });
    stage_ = found == plan_.end() ? nullptr : &*found;
    if (!stage_) return;
    from_ = 0;
    for (const PlannedStage& planned : plan_)
        if (planned.end < stage_->end) from_ = std::max(from_, planned.end);
    start_round();
}

void PlannedProgress::update(const std::string& stage, double fraction, const std::string& detail)
{
    if (stage != name_) enter(stage);
    if (stage_) {
        if (fraction == 0 && last_ > 0 && stage_->has_rounds) start_round();
        last_ = fraction;
        done_ = std::max(done_, from_ + std::clamp(fraction, 0.0, 1.0) * (to_ - from_));
    }
    target_.update(stage, done_, detail);
}

} // namespace pliant
