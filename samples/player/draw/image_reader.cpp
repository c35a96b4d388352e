#include "draw/image_reader.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <jpeglib.h>
#include <memory>
#include <png.h>

namespace pliant::player {
namespace {

constexpr unsigned most_pixels = 16384; // of a side: what graphics drivers take at most

// A file that is being read. Both libraries leave by longjmp where a file is wrong: so a function that calls them has no
// objects with destructors.
class ImageFile {
public:
    virtual ~ImageFile() = default;
    // Width and height; false if it is not readable.
    virtual bool open(const std::uint8_t* bytes, std::size_t size) = 0;
    virtual bool read(std::uint8_t* pixels) = 0;
    unsigned width = 0, height = 0;
};

class PngFile final : public ImageFile {
public:
    ~PngFile() override { png_destroy_read_struct(&png_, &info_, nullptr); }

    bool open(const std::uint8_t* bytes, std::size_t size) override
    {
        rest_ = bytes, rest_size_ = size;
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, [](png_structp, png_const_charp) {});
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (!info_ || setjmp(png_jmpbuf(png_))) return false;
        png_set_read_fn(png_, this, copy);
        png_set_user_limits(png_, most_pixels, most_pixels);
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1); // texts and profiles can unpack to gigabytes
        png_read_info(png_, info_);
        png_set_expand(png_);
        png_set_scale_16(png_);
        png_set_gray_to_rgb(png_);
        png_set_add_alpha(png_, 0xFF, PNG_FILLER_AFTER);
        pass_count_ = png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        width = png_get_image_width(png_, info_);
        height = png_get_image_height(png_, info_);
        return png_get_rowbytes(png_, info_) == 4 * std::size_t(width);
    }

    bool read(std::uint8_t* pixels) override
    {
        if (setjmp(png_jmpbuf(png_))) return false;
        for (int pass = 0; pass < pass_count_; ++pass)
            for (unsigned y = 0; y < height; ++y) png_read_row(png_, pixels + 4 * std::size_t(width) * y, nullptr);
        return true;
    }

private:
    [[noreturn]] static void leave(png_structp png, png_const_charp) { png_longjmp(png, 1); }

    static void copy(png_structp png, png_bytep to, std::size_t size)
    {
        PngFile& self = *static_cast<PngFile*>(png_get_io_ptr(png));
        if (size > self.rest_size_) png_error(png, "it ends early");
        std::memcpy(to, self.rest_, size);
        self.rest_ += size;
        self.rest_size_ -= size;
    }

    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    const std::uint8_t* rest_ = nullptr;
    std::size_t rest_size_ = 0;
    int pass_count_ = 1;
};

class JpegFile final : public ImageFile {
public:
    ~JpegFile() override { jpeg_destroy_decompress(&jpeg_); }

    bool open(const std::uint8_t* bytes, std::size_t size) override
    {
        jpeg_.err = jpeg_std_error(&errors_);
        errors_.error_exit = leave;
        errors_.output_message = [](j_common_ptr) {};
        jpeg_.client_data = this;
        if (setjmp(jump_)) return false;
        jpeg_create_decompress(&jpeg_);
        progress_.progress_monitor = count_scans;
        jpeg_.progress = &progress_;
        jpeg_mem_src(&jpeg_, bytes, size);
        jpeg_read_header(&jpeg_, TRUE);
        if (jpeg_.arith_code) return false; // rare, and decoded for all pixels of every scan, also after the data has ended
        jpeg_.out_color_space = JCS_EXT_RGBA;
        width = jpeg_.image_width;
        height = jpeg_.image_height;
        return std::max(width, height) <= most_pixels;
    }

    bool read(std::uint8_t* pixels) override
    {
        if (setjmp(jump_)) return false;
        jpeg_start_decompress(&jpeg_);
        while (jpeg_.output_scanline < height) {
            JSAMPROW row = pixels + 4 * std::size_t(width) * jpeg_.output_scanline;
            jpeg_read_scanlines(&jpeg_, &row, 1);
        }
        return true;
    }

private:
    [[noreturn]] static void leave(j_common_ptr jpeg) { std::longjmp(static_cast<JpegFile*>(jpeg->client_data)->jump_, 1); }

    // A scan of a dozen bytes can go over all pixels; encoders make about ten.
    static void count_scans(j_common_ptr jpeg)
    {
        constexpr int most_scans = 64;
        if (static_cast<JpegFile*>(jpeg->client_data)->jpeg_.input_scan_number > most_scans) leave(jpeg);
    }

    jpeg_decompress_struct jpeg_ {};
    jpeg_error_mgr errors_ {};
    jpeg_progress_mgr progress_ {};
    std::jmp_buf jump_ {};
};

} // namespace

Image read_image(const std::uint8_t* bytes, std::size_t size, const std::function<void(std::size_t)>& take)
{
    Image image;
    const bool is_png = size >= 8 && png_sig_cmp(bytes, 0, 8) == 0;
    const std::unique_ptr<ImageFile> file
        = is_png ? std::unique_ptr<ImageFile>(std::make_unique<PngFile>()) : std::make_unique<JpegFile>();
    if (size == 0 || !file->open(bytes, size)) return image;
    const std::size_t pixel_size = 4 * std::size_t(file->width) * file->height;
    take(pixel_size);
    image.pixels.resize(pixel_size);
    image.width = static_cast<int>(file->width);
    image.height = static_cast<int>(file->height);
    if (!file->read(image.pixels.data())) image = {};
    return image;
}

} // namespace pliant::player
