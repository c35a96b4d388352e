// The session of a crowd.
#pragma once

#include "run/crowd_stage.h"
#include "run/session.h"

namespace pliant::player {

class CrowdSession final : public Session {
public:
    CrowdSession(const Options& options, AssetFile file, Quality quality, const GlContext& context);

    void advance(double seconds) override;
    void read_keys() override;
    void draw_scene(const Canvas& canvas, const Area& area, const Area& free, float scale) override;
    Extent extent_shown() const override { return stage_.extent_shown(); }
    void draw_panels(const Overlay& overlay, int width, int height, bool with_help) override;
    Camera& camera() override { return stage_.camera(); }
    Scene& scene() override { return stage_.scene(); }
    const AssetFile& file() const override { return file_; }

private:
    AssetFile file_;
    CrowdStage stage_;
    BlendMode mode_;
    double phase_ = 0.0;
    bool plays_ = true;
};

} // namespace pliant::player
