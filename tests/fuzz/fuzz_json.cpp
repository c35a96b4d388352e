// libFuzzer target: any bytes as the text of a configuration or a manifest, through the reader of JSON and, where it lets
// them pass, back to a text and read again. The reader takes a path: the bytes lie in a file without a name, in memory.
#include "pipeline/json_file.h"

#include <cstdlib>
#include <sys/mman.h>
#include <unistd.h>

using namespace pliant;

namespace {

void require(bool condition)
{
    if (!condition) std::abort();
}

// A file in memory and its path; made once.
struct MemoryFile {
    int descriptor = ::memfd_create("fuzz", MFD_CLOEXEC);
    std::string path = "/proc/self/fd/" + std::to_string(descriptor);

    void write(const void* bytes, std::size_t size) const
    {
        require(::ftruncate(descriptor, 0) == 0);
        require(::pwrite(descriptor, bytes, size, 0) == static_cast<ssize_t>(size));
    }
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    static const MemoryFile file;
    file.write(data, size);
    try {
        const Json json = read_json_file(file.path);
        const std::string text = json_text(json);
        file.write(text.data(), text.size());
        require(json_text(read_json_file(file.path)) == text);
        for (const auto& [key, value] : json.items()) require(!kind_of(value).empty());
    } catch (const Failure& failure) {
        require(!failure.diagnostics().empty());
    }
    return 0;
}
