#include "input/io/read_log.h"

#include "base/common/sha256.h"

#include <filesystem>
#include <system_error>

namespace pliant {
namespace {

thread_local ReadLog* innermost = nullptr;

} // namespace

WriteTime write_time(const std::string& path)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return {};
    const std::filesystem::file_time_type time = std::filesystem::last_write_time(path, error);
    if (error) return {};
    return time;
}

bool is_outdated(const ReadFile& file)
{
    const WriteTime now = write_time(file.path);
    return file.written && now && *now != *file.written;
}

ReadLog::ReadLog()
    : outer_(innermost)
{
    innermost = this;
}

ReadLog::~ReadLog() { innermost = outer_; }

void ReadLog::note(const std::string& path, const std::function<ReadFile()>& file)
{
    if (paths_.insert(path).second) files_.push_back(file());
}

void note_reading(const std::string& path, const std::optional<std::string>& bytes, const WriteTime& written)
{
    if (innermost) innermost->note(path, [&] { return ReadFile { path, bytes ? sha256_hex(*bytes) : "", "", written }; });
}

void note_link(const std::string& path)
{
    if (innermost) innermost->note(path, [&] { return ReadFile { path, "", link_place(path) }; });
}

std::string link_place(const std::string& path)
{
    std::error_code error;
    const std::filesystem::path place = std::filesystem::weakly_canonical(path, error);
    return error ? "" : place.string();
}

} // namespace pliant
