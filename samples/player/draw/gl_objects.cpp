#include "draw/gl_objects.h"

#include "blend/error.h"

#include <algorithm>

namespace pliant::player {
namespace {

// If the driver has them; every driver has four.
constexpr GLint wanted_samples = 8;

[[noreturn]] void refuse(const std::string& what)
{
    throw Error(ErrorNumber::gl_refused, ExitCode::failed, what, "try another --size or update the graphics driver");
}

GlName compile(const std::string& name, GLenum stage, const std::string& source)
{
    GlName shader(glCreateShader(stage), [](GLuint id) { glDeleteShader(id); });
    const char* text = source.c_str();
    glShaderSource(shader.get(), 1, &text, nullptr);
    glCompileShader(shader.get());
    GLint done = 0;
    glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &done);
    if (!done) {
        char log[2048] = "";
        glGetShaderInfoLog(shader.get(), sizeof log, nullptr, log);
        refuse("shader '" + name + "' was rejected by the driver: " + log);
    }
    return shader;
}

void check_framebuffer(int width, int height)
{
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        refuse("a picture of " + std::to_string(width) + " x " + std::to_string(height) + " was rejected by the driver");
}

GlName storage(GLint samples, GLenum format, int width, int height)
{
    GlName buffer = make_renderbuffer();
    glBindRenderbuffer(GL_RENDERBUFFER, buffer.get());
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    return buffer;
}

} // namespace

GlName make_buffer()
{
    GLuint name = 0;
    glGenBuffers(1, &name);
    return { name, [](GLuint id) { glDeleteBuffers(1, &id); } };
}

GlName make_vertex_array()
{
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    return { name, [](GLuint id) { glDeleteVertexArrays(1, &id); } };
}

GlName make_texture()
{
    GLuint name = 0;
    glGenTextures(1, &name);
    return { name, [](GLuint id) { glDeleteTextures(1, &id); } };
}

GlName make_framebuffer()
{
    GLuint name = 0;
    glGenFramebuffers(1, &name);
    return { name, [](GLuint id) { glDeleteFramebuffers(1, &id); } };
}

GlName make_renderbuffer()
{
    GLuint name = 0;
    glGenRenderbuffers(1, &name);
    return { name, [](GLuint id) { glDeleteRenderbuffers(1, &id); } };
}

Program::Program(const std::string& name, const std::string& vertex_source, const std::string& fragment_source)
    : program_(glCreateProgram(), [](GLuint id) { glDeleteProgram(id); })
{
    const GlName vertex = compile(name, GL_VERTEX_SHADER, vertex_source);
    const GlName fragment = compile(name, GL_FRAGMENT_SHADER, fragment_source);
    glAttachShader(program_.get(), vertex.get());
    glAttachShader(program_.get(), fragment.get());
    glLinkProgram(program_.get());
    GLint done = 0;
    glGetProgramiv(program_.get(), GL_LINK_STATUS, &done);
    if (!done) {
        char log[2048] = "";
        glGetProgramInfoLog(program_.get(), sizeof log, nullptr, log);
        refuse("program '" + name + "' was rejected by the driver: " + log);
    }
}

Canvas::Canvas(int width, int height)
    : width_(width)
    , height_(height)
{
    GLint most_samples = 1, most_pixels = 0;
    glGetIntegerv(GL_MAX_SAMPLES, &most_samples);
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most_pixels);
    if (width > most_pixels || height > most_pixels) {
        refuse("a picture of " + std::to_string(width) + " x " + std::to_string(height) + " is above the driver's limit of "
               + std::to_string(most_pixels));
    }
    const GLint samples = std::min(wanted_samples, most_samples);
    many_colours_ = storage(samples, GL_RGBA8, width, height);
    many_depths_ = storage(samples, GL_DEPTH_COMPONENT24, width, height);
    many_ = make_framebuffer();
    glBindFramebuffer(GL_FRAMEBUFFER, many_.get());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, many_colours_.get());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, many_depths_.get());
    check_framebuffer(width, height);
    one_colour_ = storage(0, GL_RGBA8, width, height);
    one_ = make_framebuffer();
    glBindFramebuffer(GL_FRAMEBUFFER, one_.get());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, one_colour_.get());
    check_framebuffer(width, height);
}

void Canvas::begin() const
{
    glBindFramebuffer(GL_FRAMEBUFFER, many_.get());
    glViewport(0, 0, width_, height_);
}

void Canvas::resolve() const
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, many_.get());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, one_.get());
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, one_.get());
    glViewport(0, 0, width_, height_);
}

void Canvas::show() const
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, one_.get());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

std::vector<std::uint8_t> Canvas::pixels() const
{
    const std::size_t row_size = static_cast<std::size_t>(width_) * 3;
    std::vector<std::uint8_t> rows(row_size * height_);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, one_.get());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, rows.data());
    const GLenum error = glGetError();
    if (error != GL_NO_ERROR) refuse("the driver reported error " + std::to_string(error) + " while drawing");
    for (int top = 0, bottom = height_ - 1; top < bottom; ++top, --bottom)
        std::swap_ranges(&rows[top * row_size], &rows[top * row_size] + row_size, &rows[bottom * row_size]);
    return rows;
}

} // namespace pliant::player
