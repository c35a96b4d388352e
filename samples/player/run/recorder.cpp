#include "run/recorder.h"

#include "blend/error.h"
#include "blend/weight_path.h"
#include "draw/image_writer.h"

#include <filesystem>

namespace pliant::player {

std::string Recorder::write_picture(const Canvas& canvas, const std::string& title)
{
    const std::string path = unused_path(title, ".png");
    write_png(path, canvas.width(), canvas.height(), canvas.pixels());
    return path;
}

std::string Recorder::start(const std::string& title)
{
    const std::string folder = unused_path(title, "");
    std::error_code error;
    if (!std::filesystem::create_directory(folder, error)) {
        throw Error(ErrorNumber::picture_not_written, ExitCode::failed,
                    folder + ": the folder cannot be made: " + error.message(),
                    "start the player in a folder that is writable");
    }
    folder_ = folder;
    count_ = 0;
    return folder;
}

// All pictures of a sequence must have one size, or no program makes a film of them.
void Recorder::add(const Canvas& canvas)
{
    const std::string folder = folder_;
    stop();
    if (count_ > 0 && (canvas.width() != width_ || canvas.height() != height_)) return;
    width_ = canvas.width();
    height_ = canvas.height();
    write_png(folder + "/" + numbered_name("recording", "frame_%04d.png", count_), width_, height_, canvas.pixels());
    ++count_;
    folder_ = folder;
}

} // namespace pliant::player
