#include "input/io/read_log.h"

#include "base/common/sha256.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

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

void ReadLog::note(const std::string& path, const std::function<std::string()>& digest)
{
    const bool is_known = std::any_of(files_.begin(), files_.end(), [&](const ReadFile& file) { return file.path == path; });
    if (!is_known) files_.push_back({ path, digest() });
}

void note_reading(const std::string& path, const std::optional<std::string>& bytes)
{
    if (innermost) innermost->note(path, [&] { return bytes ? sha256_hex(*bytes) : ""; });
}

void note_refused_link(const std::string& path)
{
    if (innermost) innermost->note(path, [&] { return link_digest(path); });
}

std::string link_digest(const std::string& path)
{
    std::error_code error;
    const std::filesystem::path target = std::filesystem::read_symlink(path, error);
    return error ? "" : sha256_hex("link to " + target.string());
}

} // namespace pliant
