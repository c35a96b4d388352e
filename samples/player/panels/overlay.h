// Dear ImGui with the player's fonts and colours; frames with and without a window.
#pragma once

#include "draw/gl_objects.h"
#include "panels/palette.h"

#include <imgui.h>

#include <set>
#include <string>
#include <vector>

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

    // Makes sure that a text can be drawn, not between begin_frame() and end_frame(). The player's own font has Latin, Greek
    // and Cyrillic letters; others, such as Chinese and Japanese ones, come from a font of the system, if there is one.
    void need_letters(const std::string& text);

    float scale() const { return scale_; }
    ImFont* text() const { return text_; }
    ImFont* small() const { return small_; }
    ImFont* title() const { return title_; }

private:
    void load_fonts();
    void set_style();

    float scale_;
    GLFWwindow* window_;
    std::set<ImWchar> other_letters_;   // that the player's own font does not have
    std::vector<ImWchar> other_ranges_; // the same as ImGui reads it
    ImFont* text_ = nullptr;
    ImFont* small_ = nullptr;
    ImFont* title_ = nullptr;
};

// Draws text with its anchor (0 to 1 in both directions) at `place`; returns the size of the text.
ImVec2 draw_text(ImDrawList* list, ImFont* font, ImVec2 place, ImVec2 anchor, ImU32 colour, const std::string& text);

// The same centred below `place`, on a plate like a panel: for texts over the scene.
void draw_caption(ImDrawList* list, ImFont* font, ImVec2 place, ImU32 colour, const std::string& text);

// Takes letters out of the middle of a text that is wider than `room` pixels: "mouthSm…Left".
std::string elided(ImFont* font, const std::string& text, float room);

// 18439 as "18,439".
std::string grouped(std::uint64_t number);

} // namespace pliant::player
