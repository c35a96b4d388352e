// Helpers of the tests that read and write files.
#pragma once

#include "base/common/diagnostics.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <unistd.h>

namespace pliant_test {

// An empty folder of our own that goes away with us.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "pliant-test-XXXXXX").string();
        if (!::mkdtemp(pattern.data())) throw std::runtime_error("cannot make a temporary folder");
        path_ = pattern;
    }
    ~TemporaryFolder()
    {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::string operator/(const std::string& name) const { return (path_ / name).string(); }
    std::string path() const { return path_.string(); }
    std::size_t file_count() const
    {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
    }

private:
    std::filesystem::path path_;
};

// A new file each time: ext4 writes a file that was emptied and filled again to the disk at once, and tests of mutations
// would wait for the disk most of the time.
inline void write_bytes(const std::string& path, const std::string& bytes)
{
    std::filesystem::remove(path);
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline std::string read_bytes(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return { std::istreambuf_iterator<char>(file), {} };
}

// The folder with real meshes, or "" if there is none.
inline std::string data_folder()
{
    const char* variable = std::getenv("PLIANT_DATA");
    const std::string folder = variable ? variable : PLIANT_SOURCE_DIR "/../shared/data";
    return std::filesystem::is_directory(folder) ? folder : "";
}

// Number of the first diagnostic of what `action` throws; 0 if it throws nothing.
template <class Action> int number_of(Action action)
{
    try {
        action();
    } catch (const pliant::Failure& failure) {
        return failure.diagnostics().at(0).number;
    }
    return 0;
}

} // namespace pliant_test
