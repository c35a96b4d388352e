// libFuzzer target: any bytes as a file of JSON that is read, written and read again; then as a configuration and as a
// manifest with their keys and values. The readers take a path: the bytes lie in a file without a name, in memory.
#include "cli/bake_request.h"
#include "cli/config_options.h"
#include "cli/manifest.h"

#include <cstdlib>
#include <sys/mman.h>
#include <unistd.h>

using namespace pliant;

namespace {

void require(bool condition)
{
    if (!condition) std::abort();
}

// A file in memory and its path.
struct MemoryFile {
    int descriptor = ::memfd_create("fuzz", MFD_CLOEXEC);
    std::string path = "/proc/self/fd/" + std::to_string(descriptor);

    void write(const void* bytes, std::size_t size) const
    {
        require(::ftruncate(descriptor, 0) == 0);
        require(::pwrite(descriptor, bytes, size, 0) == static_cast<ssize_t>(size));
    }
};

void read_and_write(const MemoryFile& file)
{
    const Json json = read_json_file(file.path);
    const std::string text = json_text(json);
    const MemoryFile written;
    written.write(text.data(), text.size());
    require(json_text(read_json_file(written.path)) == text);
    ::close(written.descriptor);
}

// As `pliant bake --config`.
void use_configuration(const std::string& path)
{
    CLI::App app;
    BakeRequest request;
    add_bake_options(app, request);
    request.config = path;
    complete_request(app, request);
    require(!request.poses.empty() && !request.output.empty());
    require(to_arguments(effective_config(app)).size() > 1);
}

// As `pliant bake-all`.
void use_manifest(const std::string& path)
{
    for (const BatchJob& job : read_manifest(path, 1))
        require(!job.name.empty() && job.name.find('/') == std::string::npos && !job.output.empty());
}

template <class F> void attempt(F&& f)
{
    try {
        f();
    } catch (const Failure& failure) {
        require(!failure.diagnostics().empty());
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    static const MemoryFile file;
    file.write(data, size);
    attempt([&] {
        read_and_write(file);
        attempt([&] { use_configuration(file.path); });
        attempt([&] { use_manifest(file.path); });
    });
    return 0;
}
