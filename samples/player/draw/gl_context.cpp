#include "draw/gl_context.h"

#include "blend/error.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pliant::player {
namespace {

constexpr char context_hint[] = "the player needs OpenGL 3.3; without a display run it as: xvfb-run -a -s \"-screen 0 "
                                "1280x1024x24\" pliant-player ... (packages xvfb xauth libgl1-mesa-dri)";

[[noreturn]] void refuse_context(const std::string& reason)
{
    throw Error(ErrorNumber::no_context, ExitCode::failed, "no picture can be drawn: " + reason, context_hint);
}

// The first has compute shaders, which rebuild shapes several times as fast; drivers may give exactly what is asked for.
struct Version {
    int major, minor;
};
constexpr Version versions[] = { { 4, 3 }, { 3, 3 } };

std::string glfw_reason()
{
    const char* reason = nullptr;
    glfwGetError(&reason);
    return reason ? reason : "GLFW gives no reason";
}

class EglContext : public GlContext {
public:
    EglContext(EGLDisplay display, EGLContext context)
        : display_(display)
        , context_(context)
    {
    }
    ~EglContext() override
    {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;
    pliant_gl_loader loader() const override { return eglGetProcAddress; }

private:
    EGLDisplay display_;
    EGLContext context_;
};

EGLDisplay surfaceless_display()
{
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base")
        || !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        return EGL_NO_DISPLAY;
    }
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
}

EGLContext context_of(EGLDisplay display, EGLConfig config)
{
    for (const auto& [major, minor] : versions) {
        const EGLint wishes[] = {
            EGL_CONTEXT_MAJOR_VERSION,           major,   EGL_CONTEXT_MINOR_VERSION, minor, EGL_CONTEXT_OPENGL_PROFILE_MASK,
            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE
        };
        const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wishes);
        if (context != EGL_NO_CONTEXT) return context;
    }
    return EGL_NO_CONTEXT;
}

std::unique_ptr<GlContext> try_egl()
{
    const EGLDisplay display = surfaceless_display();
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return nullptr;
    const EGLint config_wishes[] = { EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE };
    EGLConfig config = nullptr;
    EGLint config_count = 0;
    if (eglBindAPI(EGL_OPENGL_API) && eglChooseConfig(display, config_wishes, &config, 1, &config_count)
        && config_count > 0) {
        const EGLContext context = context_of(display, config);
        if (context != EGL_NO_CONTEXT) {
            if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
                return std::make_unique<EglContext>(display, context);
            eglDestroyContext(display, context);
        }
    }
    eglTerminate(display);
    return nullptr;
}

} // namespace

std::string GlContext::renderer_name() const { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

bool GlContext::is_software() const
{
    const std::string name = renderer_name();
    for (const char* software : { "llvmpipe", "softpipe", "SwiftShader" })
        if (name.find(software) != std::string::npos) return true;
    return false;
}

WindowContext::WindowContext(const std::string& title, int width, int height, bool visible)
{
    if (!glfwInit()) refuse_context(glfw_reason());
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
    for (const auto& [major, minor] : versions) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
        window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
        if (window_) break;
    }
    if (!window_) {
        const std::string reason = glfw_reason();
        glfwTerminate();
        refuse_context(reason);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
}

WindowContext::~WindowContext()
{
    glfwDestroyWindow(window_);
    glfwTerminate();
}

pliant_gl_loader WindowContext::loader() const { return glfwGetProcAddress; }

std::unique_ptr<GlContext> make_offscreen_context()
{
    if (std::unique_ptr<GlContext> context = try_egl()) return context;
    return std::make_unique<WindowContext>("pliant-player", 64, 64, false);
}

} // namespace pliant::player
