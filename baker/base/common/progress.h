// Progress and cancellation of long work.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace pliant {

// Thrown by Progress::update when the user has asked to stop; the command line turns it into exit code 130.
struct Interrupted {};

// Told by the baker's stages how far they are. Every stage calls update often enough that an interrupt is seen within a
// second. The default does nothing; the command line prints. Not thread-safe: one thread reports.
class Progress {
public:
    virtual ~Progress() = default;
    // stage: a few words ("subspace", "cubature"); fraction: 0 .. 1 of the whole work, or of this stage where a
    // PlannedProgress listens; detail: free text or empty.
    virtual void update(const std::string& stage, double fraction, const std::string& detail = {});
    // A warning that belongs to no input file.
    virtual void warn(int number, const std::string& what, const std::string& hint = {});
};

// For stages that run tasks on several threads: the thread that made it reports to `target` (may be null); the others are
// told to stop at their next update once that one has been interrupted.
class SharedProgress : public Progress {
public:
    explicit SharedProgress(Progress* target)
        : target_(target)
        , owner_(std::this_thread::get_id())
    {
    }
    // What updates say from now on, in place of what the work below reports. On the owner's thread.
    void describe(const std::string& stage, double fraction, const std::string& detail);
    void update(const std::string& stage, double fraction, const std::string& detail = {}) override;

private:
    Progress* target_;
    std::thread::id owner_;
    std::atomic<bool> is_interrupted_ { false };
    std::string stage_, detail_;
    double fraction_ = 0;
};

// A stage of long work, and where its bar stands at the end of the stage.
struct PlannedStage {
    std::string name;
    double end;              // 0 .. 1 of the whole work; the stage begins at the next lower end of the plan
    bool has_rounds = false; // the stage starts again at 0, nobody knows how often: a round takes a third of the way left
};

// One bar for work of several stages: reports fractions of the whole work, which never decrease. Stages that the plan does
// not name leave the bar where it stands.
class PlannedProgress : public Progress {
public:
    PlannedProgress(Progress& target, std::vector<PlannedStage> plan)
        : target_(target)
        , plan_(std::move(plan))
    {
    }
    PlannedProgress(const PlannedProgress&) = delete;
    PlannedProgress& operator=(const PlannedProgress&) = delete;
    void update(const std::string& stage, double fraction, const std::string& detail = {}) override;
    void warn(int number, const std::string& what, const std::string& hint = {}) override
    {
        target_.warn(number, what, hint);
    }

private:
    void enter(const std::string& stage);
    void start_round();

    Progress& target_;
    std::vector<PlannedStage> plan_;
    const PlannedStage* stage_ = nullptr; // the current one, null: not in the plan
    std::string name_;
    double from_ = 0, to_ = 0; // of the current stage or its current round, in the whole work
    double last_ = 0;          // the last fraction of the stage
    double done_ = 0;          // of the whole work
};

} // namespace pliant
