#include "run/pictures.h"

#include "draw/gl_context.h"
#include "draw/image_writer.h"
#include "panels/hud_crowd.h"
#include "panels/hud_heat.h"
#include "panels/overlay.h"
#include "run/blend_session.h"
#include "run/crowd_stage.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace pliant::player {
namespace {

constexpr int default_width = 1280, default_height = 800;
constexpr double seconds_between_reports = 5.0; // not on a terminal; there one line is updated for every picture

// For the medians in the panels of a single picture, this many blends are measured. The frames of a crowd can take long, so
// measuring them stops after some seconds.
constexpr int measured_blends = 60;
constexpr double measured_seconds = 6.0;

// Panels are designed for pictures of 900 rows.
float design_scale(int height) { return std::clamp(static_cast<float>(height) / 900.0f, 0.6f, 3.0f); }

// Everything that a picture needs except its contents.
struct Easel {
    int width, height;
    std::unique_ptr<GlContext> context;
    Canvas canvas;
    Overlay overlay;
    bool hud;

    Easel(const Options& options, const AssetFile& file)
        : width(options.width > 0 ? options.width : default_width)
        , height(options.height > 0 ? options.height : default_height)
        , context(make_offscreen_context())
        , canvas(width, height)
        , overlay(design_scale(options.hud ? height : std::max(height, width * 3 / 5)),
                  nullptr) // wide strips get larger captions
        , hud(options.hud)
    {
        overlay.need_letters(file.letters());
    }
    Area whole() const { return { 0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height) }; }
    Area free() const { return hud ? free_area(overlay.scale(), width, height) : whole(); }

    // Runs ImGui calls three times: panels that fit their contents have the right size only in the second frame, and lists
    // below them know in the third one, which is drawn, whether they scroll.
    void draw_over(const std::function<void()>& panels)
    {
        for (int unseen = 0; unseen < 2; ++unseen) {
            overlay.begin_frame(width, height);
            panels();
            overlay.discard_frame();
        }
        overlay.begin_frame(width, height);
        panels();
        overlay.end_frame();
    }
};

// The contents of pictures: draws one at a phase of the loop (0 to 1).
class Subject {
public:
    virtual ~Subject() = default;
    virtual void draw(Easel& easel, double phase) = 0;
    // Lets all of `count` pictures have one view, which fits them.
    virtual void frame_all(std::size_t) {}
};

class BlendSubject final : public Subject {
public:
    BlendSubject(const Options& options, const AssetFile& file, const Truth* truth)
        : file_(file)
        , path_(path_for(options, file))
        , weights_(weights_for(options, file))
        , stage_(options, file, truth, Quality::high)
        , show_(first_show(options))
        , heat_(options.heat)
        , moves_(!options.sequence.empty())
        , has_lines_(!options.path.empty())
    {
    }

    void draw(Easel& easel, double phase) override
    {
        const std::vector<double> weights = weights_at(phase);
        // A single picture shows medians, as a window does, but with cold solves.
        const int repeats = easel.hud && !moves_ ? measured_blends : 1;
        for (int i = 0; i < repeats; ++i) {
            if (!moves_) stage_.forget();
            history_.add(stage_.blend(weights, show_, heat_).cost);
        }
        if (!moves_) stage_.camera().frame(stage_.extent_shown());
        const bool has_panels = easel.hud || heat_;
        easel.canvas.begin();
        stage_.draw(easel.canvas, easel.whole(), easel.free(), has_panels ? easel.overlay.scale() : 0.0f);
        easel.canvas.resolve();
        if (!has_panels) return;
        const HudModel model { file_,
                               stage_.polygon(),
                               stage_.shown(),
                               stage_.truth(),
                               weights,
                               stage_.polygon().point(weights),
                               has_lines_ ? std::optional<double>(phase * static_cast<double>(path_->count()))
                                          : std::nullopt,
                               has_lines_ ? path_->count() : 0,
                               true,
                               stage_.has_paint(),
                               history_.median(&BlendCost::solve_us),
                               history_.median(&BlendCost::reconstruct_us),
                               history_.median(&BlendCost::normals_us) };
        easel.draw_over([&] {
            if (easel.hud) draw_hud(easel.overlay, model, sliders_, easel.width, easel.height);
            std::vector<glm::vec2> places = stage_.caption_places();
            for (glm::vec2& place : places) place *= glm::vec2(easel.width, easel.height);
            draw_side_captions(easel.overlay, stage_.shown(), easel.free(), places);
            draw_heat_legend(easel.overlay, stage_.shown(), easel.free());
        });
    }

    void frame_all(std::size_t count) override
    {
        ExtentOfShapes all;
        for (std::size_t i = 0; i < count; ++i) {
            stage_.blend(weights_at(static_cast<double>(i) / static_cast<double>(count)), show_);
            stage_.add_shown(all);
        }
        stage_.forget();
        stage_.camera().frame(all.extent());
    }

private:
    std::vector<double> weights_at(double phase) const
    {
        if (!moves_) return weights_;
        if (path_) return path_->at(phase * static_cast<double>(path_->count()));
        return stage_.polygon().weights(stage_.polygon().idle_point(phase));
    }

    const AssetFile& file_;
    std::optional<WeightPath> path_;
    std::vector<double> weights_;
    Stage stage_;
    CostHistory history_;
    Show show_;
    SliderState sliders_;
    bool heat_, moves_, has_lines_;
};

class CrowdSubject final : public Subject {
public:
    // With panels a crowd is lit as in a window, so that the graph shows the times of a window.
    CrowdSubject(const Options& options, const AssetFile& file, const GlContext& context)
        : file_(file)
        , stage_(options, file,
                 !options.hud                ? Quality::high
                     : context.is_software() ? Quality::low
                                             : Quality::medium,
                 context)
        , mode_(options.linear ? BlendMode::linear : BlendMode::elastic)
        , moves_(!options.sequence.empty())
    {
    }

    void draw(Easel& easel, double phase) override
    {
        // The graph of a single picture shows the frames of a window from this phase on, at 60 frames per second.
        const Stopwatch watch;
        const int frames = easel.hud && !moves_ ? static_cast<int>(FrameTimes::capacity) : 1;
        for (int i = 0; i < frames && watch.microseconds() < measured_seconds * 1e6; ++i) {
            stage_.blend(phase + i / (60.0 * stage_.loop_seconds()), mode_);
            easel.canvas.begin();
            stage_.draw(easel.canvas, easel.whole(), easel.free());
        }
        easel.canvas.resolve();
        if (!easel.hud) return;
        easel.draw_over([&] {
            draw_crowd_hud(easel.overlay,
                           { file_, stage_.crowd(), stage_.times(), stage_.cost(), stage_.rebuilder(),
                             stage_.rebuilds_on_gpu(), mode_, true, stage_.has_paint() },
                           easel.width, easel.height);
        });
    }

private:
    const AssetFile& file_;
    CrowdStage stage_;
    BlendMode mode_;
    bool moves_;
};

// Reports the progress of a sequence and estimates the remaining time.
class Report {
public:
    explicit Report(std::size_t count)
        : count_(count)
        , is_terminal_(isatty(STDERR_FILENO) != 0)
    {
    }
    void add()
    {
        ++done_;
        const double seconds = watch_.microseconds() * 1e-6;
        if (!is_terminal_ && seconds - last_ < seconds_between_reports) return;
        last_ = seconds;
        const double left = seconds / static_cast<double>(done_) * static_cast<double>(count_ - done_);
        std::fprintf(stderr, "%spliant-player: %zu of %zu pictures, %.0f s left%s", is_terminal_ ? "\r" : "", done_, count_,
                     left, is_terminal_ ? "\033[K" : "\n");
        if (is_terminal_ && done_ == count_) std::fputc('\n', stderr);
    }

private:
    Stopwatch watch_;
    std::size_t count_, done_ = 0;
    double last_ = 0.0;
    bool is_terminal_;
};

std::unique_ptr<Subject> subject_for(const Options& options, const AssetFile& file, const Truth* truth, const Easel& easel)
{
    if (options.crowd > 0) return std::make_unique<CrowdSubject>(options, file, *easel.context);
    return std::make_unique<BlendSubject>(options, file, truth);
}

} // namespace

void write_screenshot(const Options& options, const AssetFile& file)
{
    const std::optional<Truth> truth = truth_for(options, file); // reports wrong files before a missing driver
    Easel easel(options, file);
    const std::unique_ptr<Subject> subject = subject_for(options, file, truth ? &*truth : nullptr, easel);
    subject->draw(easel, 0.0);
    write_png(options.screenshot, easel.width, easel.height, easel.canvas.pixels());
}

void write_sequence(const Options& options, const AssetFile& file)
{
    const std::optional<WeightPath> path = path_for(options, file);
    const std::optional<Truth> truth = truth_for(options, file);
    const std::size_t count = options.count > 0 ? static_cast<std::size_t>(options.count) : path->count();
    Easel easel(options, file);
    const std::unique_ptr<Subject> subject = subject_for(options, file, truth ? &*truth : nullptr, easel);
    subject->frame_all(count);
    Report report(count);
    for (std::size_t i = 0; i < count; ++i) {
        subject->draw(easel, static_cast<double>(i) / static_cast<double>(count));
        write_png(numbered_name("--sequence", options.sequence, i), easel.width, easel.height, easel.canvas.pixels());
        report.add();
    }
}

} // namespace pliant::player
