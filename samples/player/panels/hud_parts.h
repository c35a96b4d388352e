// Parts that the panels of all sessions share.
#pragma once

#include "blend/asset_file.h"
#include "draw/camera.h"
#include "panels/overlay.h"

#include <string>
#include <utility>
#include <vector>

namespace pliant::player {

// Layout, in pixels of the design.
// panel_gap: between panels.
constexpr float panel_margin = 18.0f, panel_width = 316.0f, panel_gap = 10.0f;

constexpr ImGuiWindowFlags panel_flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove
    | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoSavedSettings
    | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

// The part of the picture that the panels leave free.
Area free_area(float scale, int width, int height);

// A label on the left and a value on the right of the panel.
void row(const Overlay& overlay, const char* label, const std::string& value);
// A title and one line of facts below it.
void heading(const Overlay& overlay, const std::string& title, const std::string& facts);

// Begins the panel at the top left, with the asset's title and size. End it with ImGui::End().
void begin_facts(const Overlay& overlay, const AssetFile& file);

std::string microseconds(double value);
std::string milliseconds(double value);
// A share as a percentage with two significant digits: "0.034 %".
std::string percent(double share);

// A key and its effect, for the strip at the bottom.
using Key = std::pair<const char*, const char*>;
// Those that every window has, for the end of the strip.
extern const std::vector<Key> keys_of_all;
void draw_keys(const Overlay& overlay, const std::vector<Key>& keys, bool shown, int width, int height);

// A message over the scene: a file was opened, or was refused.
struct Notice {
    std::string text; // empty: none
    bool is_error = false;
};
void draw_notice(const Overlay& overlay, const Notice& notice, int width, int height);

} // namespace pliant::player
