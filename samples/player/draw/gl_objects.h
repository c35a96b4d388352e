// Owning wrappers of the OpenGL objects that the player needs.
#pragma once

#include <epoxy/gl.h>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pliant::player {

// One OpenGL name and the call that deletes it.
class GlName {
public:
    using Delete = void (*)(GLuint);
    GlName() = default;
    GlName(GLuint name, Delete del)
        : name_(name)
        , delete_(del)
    {
    }
    GlName(GlName&& other) noexcept { swap(other); }
    GlName& operator=(GlName&& other) noexcept
    {
        swap(other);
        return *this;
    }
    ~GlName()
    {
        if (name_ != 0) delete_(name_);
    }
    GLuint get() const { return name_; }

private:
    void swap(GlName& other)
    {
        std::swap(name_, other.name_);
        std::swap(delete_, other.delete_);
    }
    GLuint name_ = 0;
    Delete delete_ = nullptr;
};

GlName make_buffer();
GlName make_vertex_array();
GlName make_texture();
GlName make_framebuffer();
GlName make_renderbuffer();

// A linked program. Throws Error with the driver's log.
class Program {
public:
    Program(const std::string& name, const std::string& vertex_source, const std::string& fragment_source);

    void use() const { glUseProgram(program_.get()); }
    void set(const char* uniform, int value) const { glUniform1i(at(uniform), value); }
    void set(const char* uniform, float value) const { glUniform1f(at(uniform), value); }
    void set(const char* uniform, glm::vec2 value) const { glUniform2f(at(uniform), value.x, value.y); }
    void set(const char* uniform, glm::vec3 value) const { glUniform3f(at(uniform), value.x, value.y, value.z); }
    void set(const char* uniform, glm::vec4 value) const { glUniform4f(at(uniform), value.x, value.y, value.z, value.w); }
    void set(const char* uniform, const glm::mat4& value) const { set(uniform, &value, 1); }
    void set(const char* uniform, const glm::mat4* values, int count) const
    {
        glUniformMatrix4fv(at(uniform), count, GL_FALSE, &values[0][0].x);
    }
    void set(const char* uniform, const glm::vec3* values, int count) const
    {
        glUniform3fv(at(uniform), count, &values[0].x);
    }
    void set(const char* uniform, const glm::vec4* values, int count) const
    {
        glUniform4fv(at(uniform), count, &values[0].x);
    }

private:
    GLint at(const char* uniform) const { return glGetUniformLocation(program_.get(), uniform); }
    GlName program_;
};

// A multisampled picture to draw into, and the same picture resolved.
class Canvas {
public:
    // Throws Error if the driver refuses that size.
    Canvas(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }
    // Draw the scene between begin and resolve, overlays after resolve.
    void begin() const;
    void resolve() const;
    // Copies the resolved picture to the window.
    void show() const;
    // RGB, top row first.
    std::vector<std::uint8_t> pixels() const;

private:
    int width_, height_;
    GlName many_colours_, many_depths_, many_, one_colour_, one_;
};

} // namespace pliant::player
