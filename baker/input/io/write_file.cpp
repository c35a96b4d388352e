#include "input/io/write_file.h"

#include "base/common/diagnostics.h"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <mutex>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view temporary_infix = ".pliant-tmp-";

[[noreturn]] void fail(Diagnostic diagnostic) { throw Failure(ExitCode::failed, std::move(diagnostic)); }

[[noreturn]] void fail_writing(const std::string& path, int system_error)
{
    fail(error_at(4005, path, fmt::format("cannot be written: {}", std::strerror(system_error)),
                  "free space or choose another folder; the old file, if any, is untouched"));
}

// Where the bytes really go: the folder and the name in it, symbolic links followed.
struct Target {
    std::string path; // as the user gave it, for messages
    fs::path folder;
    std::string name;
    mode_t mode = 0; // permissions of the existing file; 0 if there is none

    fs::path file() const { return folder / name; }
};

Target resolve(const std::string& path)
{
    Target target { path, {}, {}, 0 };
    fs::path file = path;
    std::error_code error;
    if (fs::is_symlink(file, error)) {
        file = fs::canonical(file, error);
        if (error) fail(error_at(4006, path, "is a link that leads nowhere", "remove the link or name another output"));
    }
    target.folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    target.name = file.filename().string();
    if (target.name.empty() || target.name == "." || target.name == "..") {
        fail(error_at(4003, path, "is a folder", "name a file in it"));
    }
    if (!fs::is_directory(target.folder, error)) {
        fail(error_at(4001, path, fmt::format("there is no folder {}", target.folder.string()), "create the folder first"));
    }
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) return target;
    if (S_ISDIR(status.st_mode)) fail(error_at(4003, path, "is a folder", "name a file in it"));
    // Renaming over a device or a pipe would replace it.
    if (!S_ISREG(status.st_mode)) fail(error_at(4006, path, "is not a regular file", "name another output"));
    target.mode = status.st_mode & 07777;
    return target;
}

// Names may have 255 bytes; a very long one is cut so that the temporary's still fits.
std::string temporary_prefix(const std::string& name)
{
    constexpr std::size_t room = 255 - 1 - temporary_infix.size() - 20;
    return fmt::format(".{}{}", name.substr(0, room), temporary_infix);
}

// A writer that was killed leaves its temporary; whoever writes the same name next clears it away. A process that we may not
// signal is alive.
void remove_stale_temporaries(const Target& target)
{
    const std::string prefix = temporary_prefix(target.name);
    std::error_code error;
    for (fs::directory_iterator entry(target.folder, error), end; !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if (name.compare(0, prefix.size(), prefix) != 0) continue;
        pid_t pid = 0;
        const auto [last, failed] = std::from_chars(name.data() + prefix.size(), name.data() + name.size(), pid);
        if (failed != std::errc() || last != name.data() + name.size() || pid <= 0) continue;
        const bool is_dead = ::kill(pid, 0) != 0 && errno == ESRCH;
        if (is_dead) ::unlink(entry->path().c_str());
    }
}

// A file that is gone again unless it was given its name.
class Temporary {
public:
    explicit Temporary(const Target& target);
    ~Temporary();
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;

    void write(std::string_view bytes);
    void flush();
    void take_name();

private:
    const Target& target_;
    std::string path_;
    int descriptor_ = -1;
    bool is_named_ = false;
};

Temporary::Temporary(const Target& target)
    : target_(target)
    , path_((target.folder / fmt::format("{}{}", temporary_prefix(target.name), ::getpid())).string())
{
    const auto create = [&] { return ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); };
    descriptor_ = create();
    if (descriptor_ < 0 && errno == EEXIST) {
        // Our own process id, and this process writes one file at a time: left by a dead process of the same number.
        ::unlink(path_.c_str());
        descriptor_ = create();
    }
    if (descriptor_ >= 0) return;
    fail(error_at(4002, target.path,
                  fmt::format("cannot be created in the folder {}: {}", target.folder.string(), std::strerror(errno)),
                  "choose a folder that you may write to"));
}

Temporary::~Temporary()
{
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!is_named_) ::unlink(path_.c_str());
}

void Temporary::write(std::string_view bytes)
{
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_writing(target_.path, errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void Temporary::flush()
{
    if (target_.mode != 0 && ::fchmod(descriptor_, target_.mode) != 0) fail_writing(target_.path, errno);
    if (::fsync(descriptor_) != 0) fail_writing(target_.path, errno);
    const int descriptor = std::exchange(descriptor_, -1); // close may fail, but the descriptor is gone then, too
    if (::close(descriptor) != 0) fail_writing(target_.path, errno);
}

void Temporary::take_name()
{
    if (::rename(path_.c_str(), target_.file().c_str()) != 0) fail_writing(target_.path, errno);
    is_named_ = true;
}

// Makes the new name itself durable. Some file systems cannot, and the content is safe by then: not an error.
void flush_folder(const fs::path& folder)
{
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

// One temporary per process and name: threads take turns.
std::mutex writing;

} // namespace

void write_file_atomically(const std::string& path, std::string_view bytes)
{
    const std::lock_guard<std::mutex> lock(writing);
    const Target target = resolve(path);
    remove_stale_temporaries(target);
    Temporary temporary(target);
    temporary.write(bytes);
    temporary.flush();
    temporary.take_name();
    flush_folder(target.folder);
}

void probe_output(const std::string& path, const std::vector<std::string>& inputs)
{
    const std::lock_guard<std::mutex> lock(writing);
    const Target target = resolve(path);
    for (const std::string& input : inputs) {
        std::error_code error;
        if (!fs::equivalent(target.file(), input, error) || error) continue;
        fail(error_at(4004, path, fmt::format("is also the input {}", input), "give the output another name"));
    }
    remove_stale_temporaries(target);
    const Temporary temporary(target); // created and, at the end of this scope, removed
}

} // namespace pliant
