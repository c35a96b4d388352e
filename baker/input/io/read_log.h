// Which files were read, and what was in them: for dependency files and stamps.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace pliant {

// When a regular file was written last; pipes have no time of their own.
using WriteTime = std::optional<std::filesystem::file_time_type>;
WriteTime write_time(const std::string& path);

struct ReadFile {
    std::string path;       // as it was opened
    std::string digest;     // SHA-256 of its bytes; empty: could not be read
    std::string place;      // of a file that was not read by this name: what its links lead to; else empty
    WriteTime written = {}; // before it was opened: a write during the reading makes it outdated, too
};

// Whether it was written again since it was read.
bool is_outdated(const ReadFile& file);

// While one lives, every read_bytes of its thread is noted in it, each path once, in the order of the first reading. Logs of
// one thread nest: the innermost one notes.
class ReadLog {
public:
    ReadLog();
    ~ReadLog();
    ReadLog(const ReadLog&) = delete;
    ReadLog& operator=(const ReadLog&) = delete;

    const std::vector<ReadFile>& files() const { return files_; }

private:
    friend void note_reading(const std::string& path, const std::optional<std::string>& bytes, const WriteTime& written);
    friend void note_link(const std::string& path);

    // Once each path.
    void note(const std::string& path, const std::function<ReadFile()>& file);

    std::vector<ReadFile> files_;
    std::unordered_set<std::string> paths_; // of files_
    ReadLog* outer_;
};

// Notes that the file was read, or that it could not be; `written`: its time before it was opened. For read_bytes.
void note_reading(const std::string& path, const std::optional<std::string>& bytes, const WriteTime& written);
// Notes where the links of a name lead, in place of the content: the file was refused, or was read by another name. The
// links are its own and those of the folders on the way.
void note_link(const std::string& path);
// That place; empty if it cannot be looked up.
std::string link_place(const std::string& path);

} // namespace pliant
