#include "panels/hud_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::player {
namespace {

constexpr float help_height = 84.0f; // kept free of characters, whether help is shown or not

} // namespace

Area free_area(float scale, int width, int height)
{
    const float left = std::min((panel_width + panel_margin) * scale, 0.5f * static_cast<float>(width));
    return { left, 0.0f, static_cast<float>(width) - left, static_cast<float>(height) - help_height * scale };
}

void row(const Overlay& overlay, const char* label, const std::string& value)
{
    ImGui::PushStyleColor(ImGuiCol_Text, faint_ink);
    ImGui::TextUnformatted(label);
    ImGui::PopStyleColor();
    const float room = ImGui::GetWindowWidth() - 18.0f * overlay.scale();
    ImGui::SameLine(room - ImGui::CalcTextSize(value.c_str()).x);
    ImGui::TextUnformatted(value.c_str());
}

void heading(const Overlay& overlay, const std::string& title, const std::string& facts)
{
    ImGui::PushFont(overlay.title());
    ImGui::TextUnformatted(title.c_str());
    ImGui::PopFont();
    ImGui::PushFont(overlay.small());
    ImGui::PushStyleColor(ImGuiCol_Text, faint_ink);
    ImGui::TextUnformatted(facts.c_str());
    ImGui::PopStyleColor();
    ImGui::PopFont();
    ImGui::Dummy({ 0.0f, 3.0f * overlay.scale() });
}

void begin_facts(const Overlay& overlay, const AssetFile& file)
{
    const float s = overlay.scale();
    ImGui::SetNextWindowPos({ panel_margin * s, panel_margin * s });
    ImGui::SetNextWindowSize({ panel_width * s, 0.0f });
    ImGui::Begin("facts", nullptr, panel_flags | ImGuiWindowFlags_AlwaysAutoResize);
    const pliant_asset& asset = file.view();
    heading(overlay, file.title(),
            file.counted() + " · " + grouped(asset.vertex_count) + " vertices · d = " + std::to_string(asset.dimension));
}

std::string microseconds(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, value < 10.0 ? "%.1f µs" : "%.0f µs", value);
    return text;
}

std::string milliseconds(double value)
{
    char text[32];
    if (value >= 1e4) {
        std::snprintf(text, sizeof text, "%.1f s", value * 1e-3);
    } else {
        std::snprintf(text, sizeof text, value < 10.0 ? "%.2f ms" : value < 100.0 ? "%.1f ms" : "%.0f ms", value);
    }
    return text;
}

std::string percent(double share)
{
    char text[32];
    const double value = 100.0 * share;
    const int digits = value >= 10.0 ? 0 : value >= 1.0 ? 1 : value >= 0.1 ? 2 : value >= 0.01 ? 3 : 4;
    std::snprintf(text, sizeof text, "%.*f %%", digits, value);
    return text;
}

const std::vector<Key> keys_of_all
    = { { "W", "wireframe" },  { "P", "write a picture" },   { "V", "record" },    { "F", "frame all" },
        { "R", "reset view" }, { "drop a file", "open it" }, { "H", "hide help" }, { "Esc", "quit" } };

// One strip at the bottom, with as many lines as it needs.
void draw_keys(const Overlay& overlay, const std::vector<Key>& keys, bool shown, int width, int height)
{
    const float s = overlay.scale();
    const Area free = free_area(s, width, height);
    const float room = free.width - 2.0f * panel_margin * s;
    ImGui::SetNextWindowPos({ free.x + free.width - panel_margin * s, static_cast<float>(height) - panel_margin * s }, 0,
                            { 1.0f, 1.0f });
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, { 14.0f * s, 9.0f * s });
    ImGui::Begin("help", nullptr, panel_flags | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
    ImGui::PushFont(overlay.small());
    if (shown) {
        const float gap = 18.0f * s, between = 6.0f * s;
        float x = 0.0f;
        for (const auto& [key, meaning] : keys) {
            const float needed = ImGui::CalcTextSize(key).x + between + ImGui::CalcTextSize(meaning).x;
            const bool same_line = x > 0.0f && x + gap + needed < room - 2.0f * 14.0f * s;
            if (same_line) ImGui::SameLine(0.0f, gap);
            x = same_line ? x + gap + needed : needed;
            ImGui::TextUnformatted(key);
            ImGui::SameLine(0.0f, between);
            ImGui::PushStyleColor(ImGuiCol_Text, faint_ink);
            ImGui::TextUnformatted(meaning);
            ImGui::PopStyleColor();
        }
    } else {
        ImGui::TextUnformatted("H  help");
    }
    ImGui::PopFont();
    ImGui::End();
    ImGui::PopStyleVar();
}

void draw_notice(const Overlay& overlay, const Notice& notice, int width, int height)
{
    if (notice.text.empty()) return;
    const float s = overlay.scale();
    const Area free = free_area(s, width, height);
    const float room = std::min(free.width - 2.0f * panel_margin * s, 760.0f * s);
    const float needed = ImGui::CalcTextSize(notice.text.c_str(), nullptr, false, room - 36.0f * s).x + 36.0f * s;
    ImGui::SetNextWindowPos({ free.x + 0.5f * free.width, free.y + panel_margin * s }, 0, { 0.5f, 0.0f });
    ImGui::SetNextWindowSize({ std::min(room, needed + 2.0f * s), 0.0f });
    ImGui::PushStyleColor(ImGuiCol_WindowBg, notice.is_error ? error_panel : panel);
    ImGui::Begin("notice", nullptr, panel_flags | ImGuiWindowFlags_NoInputs);
    ImGui::PushStyleColor(ImGuiCol_Text, notice.is_error ? error_ink : ink);
    ImGui::TextWrapped("%s", notice.text.c_str());
    ImGui::PopStyleColor(2);
    ImGui::End();
}

} // namespace pliant::player
