// An OpenGL 3.3 core context: of a window, or without a display.
#pragma once

#include <pliant_gl.h>

#include <memory>
#include <string>

struct GLFWwindow;

namespace pliant::player {

// Current on the thread that created it, for its lifetime. One at a time.
class GlContext {
public:
    virtual ~GlContext() = default;
    // Loads GL functions.
    virtual pliant_gl_loader loader() const = 0;
    // The driver's name for its renderer.
    std::string renderer_name() const;
    // Whether the driver renders on the processor. The window then uses fewer lights, to stay interactive.
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

// For pictures: EGL without a surface (needs no display) or, where that fails, an invisible window.
std::unique_ptr<GlContext> make_offscreen_context();

} // namespace pliant::player
