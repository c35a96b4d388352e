// Progress and cancellation of long work.
#pragma once

#include <string>

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

} // namespace pliant
