// The session of one character, blended by the point in the control polygon or along a path, with all kinds of blend.
#pragma once

#include "blend/playback.h"
#include "panels/hud.h"
#include "run/session.h"
#include "run/stage.h"

#include <optional>

namespace pliant::player {

// The unreduced averages that the options name, if any. Throws Error.
std::optional<Truth> truth_for(const Options& options, const AssetFile& file);

// The kinds of blend to show at the start.
Show first_show(const Options& options);

class BlendSession final : public Session {
public:
    BlendSession(const Options& options, AssetFile file, Quality quality);

    void advance(double seconds) override { playback_.advance(seconds); }
    void read_keys() override;
    void draw_scene(const Canvas& canvas, const Area& area, const Area& free, float scale) override;
    Extent extent_shown() const override { return stage_.extent_shown(); }
    void draw_panels(const Overlay& overlay, int width, int height, bool with_help) override;
    Camera& camera() override { return stage_.camera(); }
    Scene& scene() override { return stage_.scene(); }
    const AssetFile& file() const override { return file_; }

private:
    void set_weight(std::uint32_t which, double value);
    void reset_weights();

    AssetFile file_;
    std::optional<Truth> truth_;
    Stage stage_;
    Playback playback_;
    CostHistory history_;
    Show show_;
    bool heat_;
    bool has_lines_; // the path is a given one
    SliderState sliders_;
};

} // namespace pliant::player
