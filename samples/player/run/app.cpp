#include "run/app.h"

#include "blend/error.h"
#include "draw/gl_context.h"
#include "panels/hud_parts.h"
#include "run/recorder.h"
#include "run/session.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace pliant::player {
namespace {

constexpr int default_width = 1280, default_height = 800;
constexpr int least_width_with_help = 900; // in a narrow window the keys would cover the characters
constexpr double degrees_per_pixel = 0.35;
constexpr double zoom_per_notch = 0.9;
constexpr double longest_step = 0.1; // seconds: after a slow frame the motion must not jump
constexpr double notice_seconds = 5.0;

class App {
public:
    App(const Options& options, AssetFile file);
    void run();

private:
    void read_keys();
    void read_scene_mouse();
    void draw_frame(int width, int height);
    void open_dropped_file();
    void write_pictures();
    void toggle_recording();
    void end_recording();
    void show_error(const Error& error);
    void set_message(const std::string& text, bool is_error, double seconds);

    Options options_;
    WindowContext context_;
    Quality quality_;
    std::unique_ptr<Session> session_;
    Overlay overlay_;
    std::unique_ptr<Canvas> canvas_;
    std::string dropped_; // path of a dropped file that is not opened yet
    Recorder recorder_;
    bool wants_picture_ = false;
    Notice notice_;
    double notice_ends_ = 0.0; // in GLFW's time
    bool help_;
    bool ends_ = false;
};

float content_scale(GLFWwindow* window)
{
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(window, &x, &y);
    int framebuffer = 1, points = 1, unused = 0;
    glfwGetFramebufferSize(window, &framebuffer, &unused);
    glfwGetWindowSize(window, &points, &unused);
    // Where window sizes are in points (macOS, Wayland), ImGui's back end scales already.
    return framebuffer > points ? 1.0f : std::max(1.0f, y);
}

App::App(const Options& options, AssetFile file)
    : options_(options)
    , context_("Pliant", options.width > 0 ? options.width : default_width,
               options.height > 0 ? options.height : default_height, true)
    , quality_(context_.is_software() ? Quality::low : Quality::medium)
    , session_(open_session(options, std::move(file), quality_, context_))
    , overlay_(content_scale(context_.window()), context_.window())
    , help_(options.width == 0 || options.width >= least_width_with_help)
{
    overlay_.need_letters(session_->file().letters());
    glfwSetWindowTitle(context_.window(), (session_->file().title() + " · Pliant").c_str());
    glfwSetWindowUserPointer(context_.window(), &dropped_);
    glfwSetDropCallback(context_.window(), [](GLFWwindow* window, int count, const char** paths) {
        if (count > 0) *static_cast<std::string*>(glfwGetWindowUserPointer(window)) = paths[0];
    });
}

void App::set_message(const std::string& text, bool is_error, double seconds)
{
    notice_ = { text, is_error };
    notice_ends_ = glfwGetTime() + seconds;
}

void App::show_error(const Error& error)
{
    set_message("P" + std::to_string(static_cast<int>(error.number)) + ": " + error.what() + "\n" + error.hint, true,
                2.0 * notice_seconds);
}

// Completes the new session before it drops the old one: if the file is refused, nothing changes.
void App::open_dropped_file()
{
    if (dropped_.empty()) return;
    Options options = options_;
    options.asset = std::exchange(dropped_, "");
    // These options belong to the character on the command line.
    options.weights.clear();
    options.set_weights.clear();
    options.path.clear();
    options.truth_weights.clear();
    try {
        session_ = open_session(options, AssetFile(options.asset), quality_, context_);
        glfwSetWindowTitle(context_.window(), (session_->file().title() + " · Pliant").c_str());
        overlay_.need_letters(session_->file().letters());
        set_message("opened " + options.asset, false, notice_seconds);
    } catch (const Error& error) {
        show_error(error);
    }
    overlay_.need_letters(notice_.text);
}

void App::toggle_recording()
{
    try {
        if (!recorder_.records())
            recorder_.start(session_->file().title());
        else
            end_recording();
    } catch (const Error& error) {
        show_error(error);
    }
}

void App::end_recording()
{
    const std::string folder = recorder_.folder();
    recorder_.stop();
    set_message(std::to_string(recorder_.count()) + " pictures in " + folder, false, 2.0 * notice_seconds);
}

// What P and V ask for: the scene without panels.
void App::write_pictures()
{
    const std::string folder = recorder_.folder();
    try {
        if (std::exchange(wants_picture_, false))
            set_message("wrote " + Recorder::write_picture(*canvas_, session_->file().title()), false, notice_seconds);
        if (!recorder_.records()) return;
        recorder_.add(*canvas_);
        if (recorder_.records())
            set_message("recording into " + folder + ": " + std::to_string(recorder_.count()) + " pictures", false, 1.0);
        else
            set_message("the window has another size: the recording in " + folder + " has ended", true, notice_seconds);
    } catch (const Error& error) {
        show_error(error);
    }
}

void App::read_keys()
{
    if (ImGui::GetIO().WantTextInput) return; // letters belong to the search field
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, false); };
    if (pressed(GLFW_KEY_ESCAPE)) ends_ = true;
    if (pressed(GLFW_KEY_H)) help_ = !help_;
    if (pressed(GLFW_KEY_M)) session_->scene().toggle_paint();
    if (pressed(GLFW_KEY_W)) session_->scene().next_wire();
    if (pressed(GLFW_KEY_P)) wants_picture_ = true;
    if (pressed(GLFW_KEY_V)) toggle_recording();
    if (pressed(GLFW_KEY_R)) session_->camera().reset();
    if (pressed(GLFW_KEY_F) || pressed(GLFW_KEY_HOME)) session_->camera().frame(session_->extent_shown());
    session_->read_keys();
}

void App::read_scene_mouse()
{
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantCaptureMouse) return;
    const bool left = ImGui::IsMouseDown(ImGuiMouseButton_Left);
    if (ImGui::IsMouseDown(ImGuiMouseButton_Middle) || (left && io.KeyShift)) {
        session_->camera().pan(glm::vec2(io.MouseDelta.x, -io.MouseDelta.y) / io.DisplaySize.y);
    } else if (left) {
        const double yaw = -degrees_per_pixel * io.MouseDelta.x, pitch = degrees_per_pixel * io.MouseDelta.y;
        session_->camera().orbit(static_cast<float>(yaw), static_cast<float>(pitch));
    }
    if (io.MouseWheel != 0.0f) session_->camera().zoom(static_cast<float>(std::pow(zoom_per_notch, io.MouseWheel)));
}

void App::draw_frame(int width, int height)
{
    if (!canvas_ || canvas_->width() != width || canvas_->height() != height)
        canvas_ = std::make_unique<Canvas>(width, height);
    // Panels are laid out in window units, the scene in pixels; the two differ on high-density screens.
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const Area panels_leave = free_area(overlay_.scale(), static_cast<int>(window.x), static_cast<int>(window.y));
    const float x = static_cast<float>(width) / window.x, y = static_cast<float>(height) / window.y;
    const Area free { panels_leave.x * x, panels_leave.y * y, panels_leave.width * x, panels_leave.height * y };
    canvas_->begin();
    session_->draw_scene(*canvas_, { 0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height) }, free,
                         overlay_.scale() * y);
    canvas_->resolve();
    write_pictures();
    canvas_->show();
    session_->draw_panels(overlay_, static_cast<int>(window.x), static_cast<int>(window.y), help_);
    if (glfwGetTime() < notice_ends_) draw_notice(overlay_, notice_, static_cast<int>(window.x), static_cast<int>(window.y));
}

void App::run()
{
    const double start = glfwGetTime();
    double last = start;
    while (!ends_ && !glfwWindowShouldClose(context_.window())) {
        glfwPollEvents();
        open_dropped_file();
        const double now = glfwGetTime();
        session_->advance(recorder_.records() ? Recorder::seconds_per_picture : std::min(now - last, longest_step));
        last = now;
        if (options_.exit_after > 0.0 && now - start >= options_.exit_after) ends_ = true;

        int width = 0, height = 0;
        glfwGetFramebufferSize(context_.window(), &width, &height);
        if (width == 0 || height == 0) { // minimised: nothing to draw until an event brings the window back
            glfwWaitEventsTimeout(longest_step);
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

void run_window(const Options& options, AssetFile file) { App(options, std::move(file)).run(); }

} // namespace pliant::player
