// Dear ImGui with the player's fonts and colours; frames with and without a window.
#pragma once

#include "draw/gl_objects.h"

#include <imgui.h>

#include <string>

struct GLFWwindow;

namespace pliant::player {

// One at a time; needs a current GL context.
class Overlay {
public:
    // scale: pixels of the framebuffer per pixel of the design. window: null for pictures.
    Overlay(float scale, GLFWwindow* window);
    ~Overlay();
    Overlay(const Overlay&) = delete;
    Overlay& operator=(const Overlay&) = delete;

    // Make ImGui calls between begin_frame() and end_frame(). width, height: of the picture; ignored with a window.
    void begin_frame(int width, int height);
    void end_frame();     // draws into the bound framebuffer
    void discard_frame(); // draws nothing

    float scale() const { return scale_; }
    ImFont* text() const { return text_; }
    ImFont* small() const { return small_; }
    ImFont* title() const { return title_; }

private:
    void load_fonts();
    void set_style();

    float scale_;
    GLFWwindow* window_;
    ImFont* text_ = nullptr;
    ImFont* small_ = nullptr;
    ImFont* title_ = nullptr;
};

// The palette of panels and captions.
inline constexpr ImU32 ink = IM_COL32(34, 42, 56, 255);
inline constexpr ImU32 faint_ink = IM_COL32(104, 116, 136, 255);
inline constexpr ImU32 elastic_ink = IM_COL32(206, 92, 58, 255);
inline constexpr ImU32 linear_ink = IM_COL32(88, 108, 142, 255);
inline constexpr ImU32 unreduced_ink = IM_COL32(58, 128, 96, 255);
inline constexpr ImU32 sand_ink = IM_COL32(206, 184, 142, 255);

// Draws text with its anchor (0 to 1 in both directions) at `place`; returns the size of the text.
ImVec2 draw_text(ImDrawList* list, ImFont* font, ImVec2 place, ImVec2 anchor, ImU32 colour, const std::string& text);

// Cuts letters off the end of a text that is wider than `room` pixels.
std::string shortened(ImFont* font, const std::string& text, float room);
// The same from its middle: "mouthSm…Left".
std::string elided(ImFont* font, const std::string& text, float room);

// 18439 as "18,439".
std::string grouped(std::uint64_t number);

} // namespace pliant::player
