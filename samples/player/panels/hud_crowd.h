// The panels over a crowd: facts, and a graph of frame times.
#pragma once

#include "blend/crowd.h"
#include "blend/frame_times.h"
#include "panels/hud_parts.h"

namespace pliant::player {

struct CrowdModel {
    const AssetFile& file;
    const Crowd& crowd;
    const FrameTimes& times;
    const CrowdCost& cost;      // of the last frame
    const char* rebuilder = ""; // its name, for people
    bool on_gpu = false;
    BlendMode mode = BlendMode::elastic;
    bool help = true;
    bool has_paint = false;
};

void draw_crowd_hud(const Overlay& overlay, const CrowdModel& model, int width, int height);

} // namespace pliant::player
