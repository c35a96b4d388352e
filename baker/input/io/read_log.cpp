#include "input/io/read_log.h"

#include "base/common/sha256.h"

#include <algorithm>

namespace pliant {
namespace {

thread_local ReadLog* innermost = nullptr;

} // namespace

ReadLog::ReadLog()
    : outer_(innermost)
{
    innermost = this;
}

ReadLog::~ReadLog() { innermost = outer_; }

void note_reading(const std::string& path, const std::optional<std::string>& bytes)
{
    if (!innermost) return;
    std::vector<ReadFile>& files = innermost->files_;
    const bool is_known = std::any_of(files.begin(), files.end(), [&](const ReadFile& file) { return file.path == path; });
    if (!is_known) files.push_back({ path, bytes ? sha256_hex(*bytes) : "" });
}

} // namespace pliant
