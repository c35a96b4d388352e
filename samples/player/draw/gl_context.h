// An OpenGL 3.3 core context: with a window, or without any display.
#pragma once

#include <pliant_gl.h>

#include <memory>
#include <string>

struct GLFWwindow;

namespace pliant::player {

// Current on the thread that made it, for as long as it lives. One at a time.
class GlContext {
public:
    virtual ~GlContext() = default;
    // What finds GL's functions.
    virtual pliant_gl_loader loader() const = 0;
    // What the driver calls itself.
    std::string renderer_name() const;
    // Whether the driver draws on the processor: then the scene is lit more simply, to stay interactive.
    bool is_software() const;
};

class WindowContext : public GlContext {
public:
    WindowContext(const std::string& title, int width, int height, bool visible);
    ~WindowContext() override;
    WindowContext(const WindowContext&) = delete;
    WindowContext& operator=(const WindowContext&) = delete;
    pliant_gl_loader loader() const override;

    GLFWwindow* window() const { return window_; }

private:
    GLFWwindow* window_ = nullptr;
};

// For pictures: EGL without a surface (needs no display), else an invisible window.
std::unique_ptr<GlContext> make_offscreen_context();

} // namespace pliant::player
