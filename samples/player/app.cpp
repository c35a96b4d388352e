#include "app.h"

#include "gl_context.h"
#include "motion.h"
#include "overlay.h"
#include "stage.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace pliant::player {

namespace {

constexpr int kWidth = 1280, kHeight = 800;
constexpr double kDegreesPerPixel = 0.35;
constexpr double kZoomPerNotch = 0.9;
constexpr double kLongestStep = 0.1; // seconds: after a hitch the motion goes on where it was, it does not leap

class App {
public:
    App(const Options& options, const AssetFile& file);
    void run();

private:
    void read_keys();
    void read_scene_mouse();
    void act(const HudActions& actions);
    void toggle_linear() { show_ = show_ == Show::linear ? Show::elastic : Show::linear; }
    void draw_frame(int width, int height);
    // A point that nobody moved keeps the weights of the command line, which the point alone cannot express.
    std::vector<double> current_weights() const
    {
        return point_moved_ ? stage_.polygon().weights(motion_.point()) : start_weights_;
    }

    const Options& options_;
    const AssetFile& file_;
    std::vector<double> start_weights_;
    WindowContext context_;
    Stage stage_;
    Overlay overlay_;
    Motion motion_;
    CostHistory history_;
    std::unique_ptr<Canvas> canvas_;
    Show show_;
    bool point_moved_;
    bool help_ = true;
    bool ends_ = false;
};

float content_scale(GLFWwindow* window)
{
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(window, &x, &y);
    int framebuffer = 1, points = 1, unused = 0;
    glfwGetFramebufferSize(window, &framebuffer, &unused);
    glfwGetWindowSize(window, &points, &unused);
    // Where windows are measured in points (macOS, Wayland) ImGui's back end already scales.
    return framebuffer > points ? 1.0f : std::max(1.0f, y);
}

App::App(const Options& options, const AssetFile& file)
    : options_(options)
    , file_(file)
    , start_weights_(weights_for(options, file))
    , context_(file.title() + " · Pliant", options.width > 0 ? options.width : kWidth,
               options.height > 0 ? options.height : kHeight, true)
    , stage_(options, file, context_.is_software() ? Quality::low : Quality::medium)
    , overlay_(content_scale(context_.window()), context_.window())
    , motion_(stage_.polygon(), stage_.polygon().point(start_weights_), options.weights.empty())
    , show_(options.both         ? Show::both
                : options.linear ? Show::linear
                                 : Show::elastic)
    , point_moved_(options.weights.empty())
{
}

void App::read_keys()
{
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, false); };
    if (pressed(GLFW_KEY_ESCAPE)) ends_ = true;
    if (pressed(GLFW_KEY_H)) help_ = !help_;
    if (pressed(GLFW_KEY_R)) stage_.camera().reset();
    if (pressed(GLFW_KEY_L)) toggle_linear();
    if (pressed(GLFW_KEY_B)) show_ = show_ == Show::both ? Show::elastic : Show::both;
    if (pressed(GLFW_KEY_SPACE)) {
        motion_.toggle_play();
        point_moved_ = true;
    }
    for (uint32_t k = 0; k < std::min(stage_.polygon().corner_count(), 9u); ++k) {
        if (pressed(GLFW_KEY_1 + static_cast<int>(k))) {
            motion_.go_to(k);
            point_moved_ = true;
        }
    }
}

void App::read_scene_mouse()
{
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantCaptureMouse) return;
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
        const double yaw = -kDegreesPerPixel * io.MouseDelta.x, pitch = kDegreesPerPixel * io.MouseDelta.y;
        stage_.camera().orbit(static_cast<float>(yaw), static_cast<float>(pitch));
    }
    if (io.MouseWheel != 0.0f) stage_.camera().zoom(static_cast<float>(std::pow(kZoomPerNotch, io.MouseWheel)));
}

void App::act(const HudActions& actions)
{
    if (actions.show) show_ = *actions.show;
    if (actions.drag_to) motion_.drag_to(*actions.drag_to);
    if (actions.go_to) motion_.go_to(*actions.go_to);
    point_moved_ = point_moved_ || actions.drag_to || actions.go_to;
}

void App::draw_frame(int width, int height)
{
    if (!canvas_ || canvas_->width() != width || canvas_->height() != height) {
        canvas_ = std::make_unique<Canvas>(width, height);
    }
    const std::vector<double> weights = current_weights();
    const BlendCost cost = stage_.blend(weights, show_);
    history_.add(cost);

    // Panels are laid out in the window's units, the scene in pixels; they differ on screens of high density.
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const Area panels_leave = free_area(overlay_.scale(), static_cast<int>(window.x), static_cast<int>(window.y));
    const float x = static_cast<float>(width) / window.x, y = static_cast<float>(height) / window.y;
    const Area free { panels_leave.x * x, panels_leave.y * y, panels_leave.width * x, panels_leave.height * y };
    canvas_->begin();
    stage_.draw(*canvas_, { 0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height) }, free);
    canvas_->resolve();
    canvas_->show();

    const HudModel model { file_,
                           stage_.polygon(),
                           weights,
                           motion_.point(),
                           show_,
                           motion_.plays(),
                           help_,
                           cost,
                           history_.median(&BlendCost::solve_us),
                           history_.median(&BlendCost::reconstruct_us),
                           history_.median(&BlendCost::normals_us) };
    act(draw_hud(overlay_, model, static_cast<int>(window.x), static_cast<int>(window.y)));
    if (show_ == Show::both) draw_side_captions(overlay_, panels_leave);
}

void App::run()
{
    const double start = glfwGetTime();
    double last = start;
    while (!ends_ && !glfwWindowShouldClose(context_.window())) {
        glfwPollEvents();
        const double now = glfwGetTime();
        motion_.advance(std::min(now - last, kLongestStep));
        last = now;
        if (options_.exit_after > 0.0 && now - start >= options_.exit_after) ends_ = true;

        int width = 0, height = 0;
        glfwGetFramebufferSize(context_.window(), &width, &height);
        if (width == 0 || height == 0) { // minimised: nothing to draw until an event brings the window back
            glfwWaitEventsTimeout(kLongestStep);
            continue;
        }
        overlay_.begin_frame(width, height);
        read_keys();
        read_scene_mouse();
        draw_frame(width, height);
        overlay_.end_frame();
        glfwSwapBuffers(context_.window());
    }
}

} // namespace

void run_window(const Options& options, const AssetFile& file) { App(options, file).run(); }

} // namespace pliant::player
