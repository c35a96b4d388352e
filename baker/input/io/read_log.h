// Which files were read, and what was in them: for dependency files and stamps.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

struct ReadFile {
    std::string path;   // as it was opened
    std::string digest; // SHA-256 of its bytes, or of where a link leads that was not followed; empty: could not be read
};

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
    friend void note_reading(const std::string& path, const std::optional<std::string>& bytes);
    friend void note_refused_link(const std::string& path);

    // Once each path.
    void note(const std::string& path, const std::function<std::string()>& digest);

    std::vector<ReadFile> files_;
    ReadLog* outer_;
};

// Notes that the file was read, or that it could not be. For read_bytes.
void note_reading(const std::string& path, const std::optional<std::string>& bytes);
// Notes that a link was not followed.
void note_refused_link(const std::string& path);
// The digest of such a link; empty if it is none.
std::string link_digest(const std::string& path);

} // namespace pliant
