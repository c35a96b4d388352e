#include "draw/image_writer.h"

#include "blend/error.h"

// The one file that compiles stb's image writer; its warnings are not ours.
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace pliant::player {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& reason)
{
    throw Error(ErrorNumber::picture_not_written, ExitCode::failed, path + ": cannot be written: " + reason,
                "check that the folder exists, is writable and has free space");
}

void append(void* context, void* data, int size)
{
    auto& bytes = *static_cast<std::vector<std::uint8_t>*>(context);
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
}

} // namespace

void write_png(const std::string& path, int width, int height, const std::vector<std::uint8_t>& pixels)
{
    std::error_code error;
    const auto kind = std::filesystem::status(path, error).type();
    // The renaming below would replace a device or a pipe by a file.
    if (kind != std::filesystem::file_type::not_found && kind != std::filesystem::file_type::regular)
        refuse(path, "it exists and is not a regular file");
    std::vector<std::uint8_t> png;
    if (!stbi_write_png_to_func(append, &png, width, height, 3, pixels.data(), width * 3)) refuse(path, "out of memory");

    const std::string temporary = path + ".part" + std::to_string(getpid());
    std::FILE* file = std::fopen(temporary.c_str(), "wb");
    if (!file) refuse(path, std::strerror(errno));
    // Each step counts: a full disk may show only when the buffer is flushed or the file closed.
    bool written = std::fwrite(png.data(), 1, png.size(), file) == png.size();
    written = std::fflush(file) == 0 && written;
    int reason = errno;
    written = std::fclose(file) == 0 && written;
    if (written && std::rename(temporary.c_str(), path.c_str()) == 0) return;
    if (written) reason = errno;
    std::remove(temporary.c_str());
    refuse(path, std::strerror(reason));
}

std::string unused_path(const std::string& stem, const std::string& suffix)
{
    for (int number = 1;; ++number) {
        char digits[16];
        std::snprintf(digits, sizeof digits, "_%03d", number);
        const std::string path = stem + digits + suffix;
        std::error_code error;
        if (std::filesystem::symlink_status(path, error).type() == std::filesystem::file_type::not_found) return path;
        if (number == 1000000) refuse(path, "all numbers are taken");
    }
}

} // namespace pliant::player
