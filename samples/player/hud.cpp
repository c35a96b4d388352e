#include "hud.h"

#include "polygon_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::player {

namespace {

constexpr float kMargin = 18.0f, kColumn = 316.0f, kPolygonHeight = 322.0f;
constexpr float kHelpHeight = 84.0f; // kept free of characters, whether it is shown or not

constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove
    | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoSavedSettings
    | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

const char* status_text(pliant_status status)
{
    switch (status) {
    case PLIANT_STATUS_CONVERGED: return "converged";
    case PLIANT_STATUS_LIMIT: return "at its limit";
    case PLIANT_STATUS_STALLED: return "at float precision";
    }
    return "unknown";
}

void row(const Overlay& overlay, const char* label, const std::string& value)
{
    ImGui::PushStyleColor(ImGuiCol_Text, kFaintInk);
    ImGui::TextUnformatted(label);
    ImGui::PopStyleColor();
    const float room = ImGui::GetWindowWidth() - 18.0f * overlay.scale();
    ImGui::SameLine(room - ImGui::CalcTextSize(value.c_str()).x);
    ImGui::TextUnformatted(value.c_str());
}

std::string microseconds(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, value < 10.0 ? "%.1f µs" : "%.0f µs", value);
    return text;
}

void segment(const char* label, Show show, ImU32 colour, const HudModel& model, float width, HudActions& actions)
{
    const bool chosen = model.show == show;
    if (chosen) {
        ImGui::PushStyleColor(ImGuiCol_Button, colour);
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, colour);
        ImGui::PushStyleColor(ImGuiCol_ButtonActive, colour);
        ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(255, 255, 255, 255));
    }
    if (ImGui::Button(label, { width, 0.0f })) actions.show = show;
    if (chosen) ImGui::PopStyleColor(4);
}

void draw_facts(const Overlay& overlay, const HudModel& model, HudActions& actions)
{
    const float s = overlay.scale();
    ImGui::SetNextWindowPos({ kMargin * s, kMargin * s });
    ImGui::SetNextWindowSize({ kColumn * s, 0.0f });
    ImGui::Begin("facts", nullptr, kPanel | ImGuiWindowFlags_AlwaysAutoResize);

    ImGui::PushFont(overlay.title());
    ImGui::TextUnformatted(model.file.title().c_str());
    ImGui::PopFont();
    const pliant_asset& asset = model.file.view();
    ImGui::PushFont(overlay.small());
    ImGui::PushStyleColor(ImGuiCol_Text, kFaintInk);
    ImGui::Text("%u poses · %s vertices · d = %u", asset.pose_count, grouped(asset.vertex_count).c_str(), asset.dimension);
    ImGui::PopStyleColor();
    ImGui::PopFont();
    ImGui::Dummy({ 0.0f, 3.0f * s });

    const float button = (ImGui::GetContentRegionAvail().x - 2.0f * 5.0f * s) / 3.0f;
    segment("Elastic", Show::elastic, kElasticInk, model, button, actions);
    ImGui::SameLine(0.0f, 5.0f * s);
    segment("Linear", Show::linear, kLinearInk, model, button, actions);
    ImGui::SameLine(0.0f, 5.0f * s);
    segment("Both", Show::both, kInk, model, button, actions);
    ImGui::Dummy({ 0.0f, 3.0f * s });

    row(overlay, "solve", microseconds(model.solve_us));
    if (model.show == Show::linear) {
        row(overlay, "iterations", "a weighted sum");
    } else {
        const std::string work
            = std::to_string(model.cost.info.iterations) + " / " + std::to_string(model.cost.info.evaluations);
        row(overlay, "iterations / evaluations", work);
        row(overlay, "status", status_text(model.cost.info.status));
    }
    row(overlay, "reconstruct", microseconds(model.reconstruct_us));
    row(overlay, "normals", microseconds(model.normals_us));
    ImGui::End();
}

// Which drag is a grab: one that starts anywhere but on a corner, or leaves the corner that it started on. A click on a corner
// must not move the point, or a double click could not travel there.
void handle_polygon_input(const PolygonView& view, float s, HudActions& actions)
{
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const float reach = 17.0f * s;
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        actions.go_to = view.corner_at(mouse, reach);
        if (actions.go_to) return;
    }
    if (!ImGui::IsItemActive()) return;
    const ImVec2 start = ImGui::GetIO().MouseClickedPos[ImGuiMouseButton_Left];
    const bool on_corner = view.corner_at(start, reach).has_value();
    if (!on_corner || ImGui::IsMouseDragging(ImGuiMouseButton_Left, 6.0f * s)) {
        actions.drag_to = view.polygon.nearest_inside(view.point(mouse));
    }
}

void draw_polygon_panel(const Overlay& overlay, const HudModel& model, int height, HudActions& actions)
{
    const float s = overlay.scale();
    const ImVec2 size { kColumn * s, kPolygonHeight * s };
    ImGui::SetNextWindowPos({ kMargin * s, static_cast<float>(height) - (kPolygonHeight + kMargin) * s });
    ImGui::SetNextWindowSize(size);
    ImGui::Begin("polygon", nullptr, kPanel);
    const ImVec2 corner = ImGui::GetWindowPos();
    // Two poses and even numbers hang level; odd ones have a tip above and need their middle a little lower.
    const float drop = model.polygon.corner_count() % 2 == 1 ? 12.0f : 2.0f;
    const PolygonView view {
        model.polygon, model.file.short_names(), { corner.x + size.x * 0.5f, corner.y + size.y * 0.5f + drop * s }, 96.0f * s
    };
    ImGui::SetCursorPos({ 6.0f * s, 6.0f * s });
    ImGui::InvisibleButton("inside", { size.x - 12.0f * s, size.y - 12.0f * s });
    handle_polygon_input(view, s, actions);
    draw_polygon(ImGui::GetWindowDrawList(), overlay, view, model.weights, model.point, true);
    ImGui::End();
}

// One strip along the bottom, as many lines as it needs.
void draw_help(const Overlay& overlay, const HudModel& model, int width, int height)
{
    static constexpr const char* keys[][2] = {
        { "drag the point", "blend" },
        { "double click a corner", "go there" },
        { "1-9", "poses" },
        { "drag the scene", "turn" },
        { "wheel", "zoom" },
        { "L", "linear / elastic" },
        { "B", "both" },
        { "Space", "play / pause" },
        { "R", "reset view" },
        { "H", "hide help" },
        { "Esc", "quit" },
    };
    const float s = overlay.scale();
    const Area free = free_area(s, width, height);
    const float room = free.width - 2.0f * kMargin * s;
    ImGui::SetNextWindowPos({ free.x + free.width - kMargin * s, static_cast<float>(height) - kMargin * s }, 0,
                            { 1.0f, 1.0f });
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, { 14.0f * s, 9.0f * s });
    ImGui::Begin("help", nullptr, kPanel | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
    ImGui::PushFont(overlay.small());
    if (model.help) {
        const float gap = 18.0f * s, between = 6.0f * s;
        float x = 0.0f;
        for (const auto& [key, meaning] : keys) {
            const float needed = ImGui::CalcTextSize(key).x + between + ImGui::CalcTextSize(meaning).x;
            const bool same_line = x > 0.0f && x + gap + needed < room - 2.0f * 14.0f * s;
            if (same_line) ImGui::SameLine(0.0f, gap);
            x = same_line ? x + gap + needed : needed;
            ImGui::TextUnformatted(key);
            ImGui::SameLine(0.0f, between);
            ImGui::PushStyleColor(ImGuiCol_Text, kFaintInk);
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

} // namespace

HudActions draw_hud(const Overlay& overlay, const HudModel& model, int width, int height)
{
    HudActions actions;
    draw_facts(overlay, model, actions);
    draw_polygon_panel(overlay, model, height, actions);
    draw_help(overlay, model, width, height);
    return actions;
}

Area free_area(float scale, int width, int height)
{
    const float left = std::min((kColumn + kMargin) * scale, 0.5f * static_cast<float>(width));
    return { left, 0.0f, static_cast<float>(width) - left, static_cast<float>(height) - kHelpHeight * scale };
}

void draw_side_captions(const Overlay& overlay, const Area& free)
{
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const float line = free.y + free.height - 34.0f * overlay.scale();
    draw_text(list, overlay.title(), { free.x + 0.25f * free.width, line }, { 0.5f, 0.0f }, kLinearInk, "linear");
    draw_text(list, overlay.title(), { free.x + 0.75f * free.width, line }, { 0.5f, 0.0f }, kElasticInk, "elastic");
}

} // namespace pliant::player
