#include "window.h"

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <algorithm>
#include <cstddef>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <stdexcept>

namespace game {

namespace {

constexpr char vertex_source[] = R"(#version 330
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
uniform mat4 view_projection;
out vec3 world_normal;
out vec2 texture_place;
void main()
{
    gl_Position = view_projection * vec4(position, 1);
    world_normal = normal;
    texture_place = uv;
})";

constexpr char fragment_source[] = R"(#version 330
in vec3 world_normal;
in vec2 texture_place;
uniform vec4 color;
uniform sampler2D image;
uniform bool has_image;
out vec4 result;
void main()
{
    vec4 base = has_image ? color * texture(image, texture_place) : color;
    float light = 0.35 + 0.65 * max(0, dot(normalize(world_normal), normalize(vec3(0.4, 0.7, 0.6))));
    result = vec4(pow(base.rgb * light, vec3(1 / 2.2)), base.a);
})";

unsigned compile(GLenum kind, const char* source)
{
    const unsigned shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    int is_compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
    if (!is_compiled) throw std::runtime_error("a shader does not compile");
    return shader;
}

unsigned link_program()
{
    const unsigned program = glCreateProgram();
    for (const unsigned shader :
         { compile(GL_VERTEX_SHADER, vertex_source), compile(GL_FRAGMENT_SHADER, fragment_source) }) {
        glAttachShader(program, shader);
        glDeleteShader(shader); // with the program
    }
    glLinkProgram(program);
    return program;
}

} // namespace

Window::Window(const ElasticModel& model, int width, int height, bool is_visible)
    : model_(model)
{
    if (!glfwInit()) throw std::runtime_error("GLFW finds no display");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, is_visible ? GLFW_TRUE : GLFW_FALSE);
    window_ = glfwCreateWindow(width, height, "gltf_game", nullptr, nullptr);
    if (!window_) {
        glfwTerminate();
        throw std::runtime_error("there is no OpenGL 3.3");
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    program_ = link_program();
    upload_parts();
    glm::vec3 low(1e30f), high(-1e30f);
    for (const Vertex& vertex : model.vertices()) {
        low = glm::min(low, glm::make_vec3(vertex.position));
        high = glm::max(high, glm::make_vec3(vertex.position));
    }
    const glm::vec3 centre = (low + high) / 2.0f;
    std::copy_n(glm::value_ptr(centre), 3, centre_);
    radius_ = std::max(1e-6f, glm::length(high - low) / 2);
}

Window::~Window()
{
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool Window::is_open() const
{
    return !glfwWindowShouldClose(window_) && glfwGetKey(window_, GLFW_KEY_ESCAPE) != GLFW_PRESS;
}

void Window::upload_parts()
{
    glGenVertexArrays(1, &array_);
    glBindVertexArray(array_);
    glGenBuffers(1, &vertices_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    const std::size_t offsets[] = { offsetof(Vertex, position), offsetof(Vertex, normal), offsetof(Vertex, uv) };
    for (unsigned i = 0; i < 3; ++i) {
        glEnableVertexAttribArray(i);
        glVertexAttribPointer(i, i < 2 ? 3 : 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<void*>(offsets[i]));
    }
    for (const Part& part : model_.parts()) {
        unsigned buffer = 0;
        glGenBuffers(1, &buffer);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, std::ptrdiff_t(4 * part.indices.size()), part.indices.data(), GL_STATIC_DRAW);
        indices_.push_back(buffer);
        textures_.push_back(part.image < 0 ? 0 : upload_image(part.image));
    }
}

// tinygltf has decoded it: 8 bits a channel, four channels.
unsigned Window::upload_image(int number) const
{
    const tinygltf::Image& image = model_.gltf().images.at(std::size_t(number));
    if (image.image.empty() || image.bits != 8 || image.component != 4) return 0;
    unsigned texture = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image.image.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    return texture;
}

void Window::draw()
{
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    glViewport(0, 0, width, height);
    glClearColor(0.96f, 0.96f, 0.96f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glUseProgram(program_);
    const glm::vec3 centre = glm::make_vec3(centre_),
                    eye = centre + 2.6f * radius_ * glm::normalize(glm::vec3(0.5f, 0.35f, 1));
    const glm::mat4 matrix
        = glm::perspective(glm::radians(45.0f), float(width) / float(std::max(1, height)), 0.05f * radius_, 10 * radius_)
        * glm::lookAt(eye, centre, glm::vec3(0, 1, 0));
    glUniformMatrix4fv(glGetUniformLocation(program_, "view_projection"), 1, GL_FALSE, glm::value_ptr(matrix));
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBufferData(GL_ARRAY_BUFFER, std::ptrdiff_t(sizeof(Vertex) * model_.vertices().size()), model_.vertices().data(),
                 GL_STREAM_DRAW);
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        const Part& part = model_.parts()[i];
        glUniform4fv(glGetUniformLocation(program_, "color"), 1, part.color);
        glUniform1i(glGetUniformLocation(program_, "has_image"), textures_[i] != 0);
        glBindTexture(GL_TEXTURE_2D, textures_[i]);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_[i]);
        glDrawElements(GL_TRIANGLES, int(part.indices.size()), GL_UNSIGNED_INT, nullptr);
    }
}

void Window::show()
{
    glfwSwapBuffers(window_);
    glfwPollEvents();
}

void Window::save(const std::string& path) const
{
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    std::vector<char> pixels(std::size_t(3 * width * height));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadBuffer(GL_BACK);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
    std::ofstream file(path, std::ios::binary);
    file << "P6\n" << width << " " << height << "\n255\n";
    for (int row = height - 1; row >= 0; --row) file.write(&pixels[std::size_t(3 * width * row)], 3 * width);
    if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

} // namespace game
