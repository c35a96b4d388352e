// Pictures of the window's scene, one by one and as numbered sequences, in the current folder.
#pragma once

#include "draw/gl_objects.h"

#include <string>

namespace pliant::player {

class Recorder {
public:
    // A sequence has one picture for every frame; between two of them 1/30 second passes.
    static constexpr double seconds_per_picture = 1.0 / 30.0;

    // Writes TITLE_001.png, or the next number whose file does not exist. Returns its name. Throws Error.
    static std::string write_picture(const Canvas& canvas, const std::string& title);

    // start() makes the folder TITLE_001, or the next number that does not exist, for pictures that add() writes as
    // frame_0000.png and so on. Returns its name. Both throw Error; then the recording has ended.
    std::string start(const std::string& title);
    void add(const Canvas& canvas);
    void stop() { folder_.clear(); }

    bool records() const { return !folder_.empty(); }
    const std::string& folder() const { return folder_; }
    std::size_t count() const { return count_; }

private:
    std::string folder_; // empty: does not record
    std::size_t count_ = 0;
    int width_ = 0, height_ = 0;
};

} // namespace pliant::player
