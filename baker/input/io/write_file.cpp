#include "input/io/write_file.h"

#include "base/common/diagnostics.h"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <sys/file.h>
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

using FileId = std::pair<dev_t, ino_t>;

// Where the bytes really go: the folder and the name in it, symbolic links followed.
struct Target {
    std::string path; // as the user gave it, for messages
    fs::path folder;
    std::string name;
    FileId folder_id {};
    std::optional<FileId> file_id; // of the existing file
    mode_t mode = 0;               // its permissions; without setuid, setgid and sticky bit: the content is another

    fs::path file() const { return folder / name; }
};

[[noreturn]] void fail_creating(const Target& target, int system_error)
{
    fail(error_at(4002, target.path,
                  fmt::format("cannot be created in the folder {}: {}", target.folder.string(), std::strerror(system_error)),
                  system_error == ENAMETOOLONG ? "choose a shorter name" : "choose a folder that you may write to"));
}

Target resolve(const std::string& path)
{
    Target target { path, {}, {}, {}, {}, 0 };
    if (path.find('\0') != std::string::npos) // the system would write the file of the name before it
        fail(error_at(4002, path, "cannot be created: its name has a zero character", "choose another name"));
    fs::path file = path;
    std::error_code error;
    if (fs::is_symlink(file, error)) {
        file = fs::canonical(file, error);
        if (error) fail(error_at(4006, path, "is a link that leads to no file", "outputs are files: name another output"));
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
    if (::stat(target.folder.c_str(), &status) == 0) target.folder_id = { status.st_dev, status.st_ino };
    if (::stat(file.c_str(), &status) != 0) {
        if (errno == ENAMETOOLONG) fail_creating(target, errno); // the name of the temporary is cut
        return target;
    }
    if (S_ISDIR(status.st_mode)) fail(error_at(4003, path, "is a folder", "name a file in it"));
    // Renaming over a device or a pipe would replace it.
    if (!S_ISREG(status.st_mode)) fail(error_at(4006, path, "is not a regular file", "name another output"));
    // Renaming would replace it all the same; version control protects files that are not checked out.
    if (!(status.st_mode & 0222))
        fail(error_at(4006, path, "is write-protected", "make it writable (or check it out), or name another output"));
    target.file_id = FileId { status.st_dev, status.st_ino };
    target.mode = status.st_mode & 0777;
    return target;
}

// Names may have 255 bytes; a very long one is cut so that the temporary's still fits.
std::string temporary_prefix(const std::string& name)
{
    constexpr std::size_t room = 255 - 1 - temporary_infix.size() - 20;
    return fmt::format(".{}{}", name.substr(0, room), temporary_infix);
}

// Not that of any other process, on this machine or on another one that shares the folder.
std::string random_name(const std::string& prefix)
{
    std::random_device device;
    return fmt::format("{}{:08x}{:08x}", prefix, device(), device());
}

enum class Lock { ours, of_another, unknown };

// Held until the descriptor is closed, also by the death of its process. Other machines see it on NFS; some file systems
// know no locks.
Lock try_lock(int descriptor)
{
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return Lock::ours;
    return errno == EWOULDBLOCK ? Lock::of_another : Lock::unknown;
}

bool is_older_than_a_day(const struct stat& status) { return std::time(nullptr) - status.st_mtime > 86400; }

void remove_if_stale(const std::string& path)
{
    const int descriptor = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return;
    struct stat status {};
    const Lock lock = try_lock(descriptor);
    const bool is_file = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    if (is_file && (lock == Lock::ours || (lock == Lock::unknown && is_older_than_a_day(status)))) ::unlink(path.c_str());
    ::close(descriptor);
}

// A writer that was killed leaves its temporary; whoever writes the same name next clears it away. Writers that live hold a
// lock on theirs.
void remove_stale_temporaries(const Target& target)
{
    const std::string prefix = temporary_prefix(target.name);
    std::error_code error;
    for (fs::directory_iterator entry(target.folder, error), end; !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if (name.compare(0, prefix.size(), prefix) != 0) continue;
        if (name.find_first_not_of("0123456789abcdef", prefix.size()) == std::string::npos)
            remove_if_stale(entry->path().string());
    }
}

bool is_flushed(int descriptor)
{
    while (::fsync(descriptor) != 0)
        if (errno != EINTR) return false;
    return true;
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
    bool create();
    bool is_there() const;

    const Target& target_;
    const std::string wanted_path_; // now: no memory is asked for while the file is there
    std::string path_;
    int descriptor_ = -1;
    bool is_named_ = false;
};

// The name is that of the open file, which nobody has removed or replaced.
bool Temporary::is_there() const
{
    struct stat by_name {
    }, by_descriptor {};
    return ::lstat(path_.c_str(), &by_name) == 0 && ::fstat(descriptor_, &by_descriptor) == 0
        && by_name.st_ino == by_descriptor.st_ino && by_name.st_dev == by_descriptor.st_dev;
}

// False if somebody was quicker: the name was taken, or the file removed before it was locked. No other process takes the
// name of one that was there.
bool Temporary::create()
{
    path_ = (target_.folder / random_name(temporary_prefix(target_.name))).string();
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) return false;
    if (try_lock(descriptor_) != Lock::of_another && is_there()) return true;
    ::unlink(path_.c_str());
    ::close(std::exchange(descriptor_, -1));
    errno = EEXIST;
    return false;
}

Temporary::Temporary(const Target& target)
    : target_(target)
    , wanted_path_(target.file().string())
{
    for (int attempt = 0; attempt < 8; ++attempt) {
        if (create()) return;
        if (errno != EEXIST) break;
    }
    fail_creating(target, errno);
}

Temporary::~Temporary()
{
    if (!is_named_) ::unlink(path_.c_str());
    ::close(descriptor_);
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
    if (target_.file_id && ::fchmod(descriptor_, target_.mode) != 0) fail_writing(target_.path, errno);
    if (!is_flushed(descriptor_)) fail_writing(target_.path, errno);
}

// The file stays open and locked until it has its name.
void Temporary::take_name()
{
    if (!is_there()) fail_writing(target_.path, ENOENT);
    if (::rename(path_.c_str(), wanted_path_.c_str()) != 0) fail_writing(target_.path, errno);
    is_named_ = true;
}

// The folder of an output, open before anything is written: a process may have too many files open.
class Folder {
public:
    explicit Folder(const Target& target)
        : target_(target)
        , descriptor_(::open(target.folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
    {
        if (descriptor_ < 0 && errno != EACCES) fail_creating(target, errno); // folders may be writable and not readable
    }
    ~Folder()
    {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    // Makes the new name itself durable. Some file systems cannot, and the content is safe by then: not an error.
    void flush() const
    {
        if (descriptor_ < 0 || is_flushed(descriptor_)) return;
        if (errno == EINVAL || errno == EBADF || errno == EROFS || errno == ENOSYS || errno == ENOTSUP) return;
        fail(error_at(4005, target_.path,
                      fmt::format("is there, but its folder cannot be flushed to the disk: {}", std::strerror(errno)),
                      "look after the disk: if power fails now, the old file may be back"));
    }

private:
    const Target& target_;
    int descriptor_;
};

std::optional<FileId> id_of(const std::string& path)
{
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return FileId { status.st_dev, status.st_ino };
}

// Files that are spoken for, by whatever name: inputs, and outputs, which need not be there yet.
class TakenFiles {
public:
    explicit TakenFiles(const std::vector<std::string>& inputs)
    {
        for (const std::string& input : inputs)
            if (const std::optional<FileId> id = id_of(input)) files_.emplace(*id, "input " + input);
    }

    void take(const Target& target)
    {
        const std::string what = "output " + target.path;
        if (target.file_id) refuse_taken(target, files_.emplace(*target.file_id, what));
        refuse_taken(target, names_.emplace(std::pair(target.folder_id, target.name), what));
    }

private:
    template <class Place> static void refuse_taken(const Target& target, const std::pair<Place, bool>& place)
    {
        if (place.second) return;
        fail(error_at(4004, target.path, "is also the " + place.first->second, "give the output another name"));
    }

    std::map<FileId, std::string> files_;
    std::map<std::pair<FileId, std::string>, std::string> names_;
};

} // namespace

void write_file_atomically(const std::string& path, std::string_view bytes)
{
    const Target target = resolve(path);
    remove_stale_temporaries(target);
    const Folder folder(target);
    Temporary temporary(target);
    temporary.write(bytes);
    temporary.flush();
    temporary.take_name();
    folder.flush();
}

void probe_outputs(const std::vector<std::string>& paths, const std::vector<std::string>& inputs)
{
    TakenFiles taken(inputs);
    std::set<FileId> folders;
    for (const std::string& path : paths) {
        if (path.empty()) continue;
        const Target target = resolve(path);
        taken.take(target);
        if (!folders.insert(target.folder_id).second) continue; // tried already
        remove_stale_temporaries(target);
        const Temporary temporary(target); // created and, at the end of this scope, removed
    }
}

} // namespace pliant
