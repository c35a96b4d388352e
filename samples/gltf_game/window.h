// A window that shows the character with its file's materials: GLFW, OpenGL 3.3, GLM.
#pragma once

#include "elastic_model.h"

struct GLFWwindow;

namespace game {

class Window {
public:
    // Throws std::runtime_error where there is no OpenGL 3.3. The model must outlive it.
    Window(const ElasticModel& model, int width, int height, bool is_visible);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    bool is_open() const;
    void draw(); // the model's vertices as they are now
    void show(); // what was drawn

    // What was drawn and not yet shown, as a binary PPM file. Throws std::runtime_error.
    void save(const std::string& path) const;

private:
    void upload_parts();
    unsigned upload_image(int number) const;

    const ElasticModel& model_;
    GLFWwindow* window_ = nullptr;
    unsigned program_ = 0, vertices_ = 0, array_ = 0;
    std::vector<unsigned> indices_, textures_; // of each part; texture 0: none
    float centre_[3], radius_ = 1;
};

} // namespace game
