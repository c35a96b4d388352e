// Progress and cancellation of long work.
#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace pliant {

// Thrown by Progress::update when the user has asked to stop; the command line turns it into exit code 130.
struct Interrupted {};

// Told by the baker's stages how far they are. Every stage calls update often enough that an interrupt is seen within a
// second. The default does nothing; the command line prints. Not thread-safe: one thread reports.
class Progress {
public:
    virtual ~Progress() = default;
    // stage: a few words ("subspace", "cubature"); fraction: 0 .. 1 of this stage; detail: free text or empty.
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

} // namespace pliant
