#include "base/common/progress.h"

namespace pliant {

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

} // namespace pliant
