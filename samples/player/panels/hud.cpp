#include "panels/hud.h"

#include "panels/polygon_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::player {
namespace {

// The panel of the polygon; of two poses it is a line with a point on it.
float polygon_height(std::uint32_t pose_count) { return pose_count == 2 ? 104.0f : 312.0f; }

const char* status_text(pliant_status status)
{
    switch (status) {
    case PLIANT_STATUS_CONVERGED: return "converged";
    case PLIANT_STATUS_LIMIT: return "at the iteration limit";
    case PLIANT_STATUS_STALLED: return "at float precision";
    }
    return "unknown";
}

void segment(const char* label, Show show, ImU32 colour, const HudModel& model, float width, HudActions& actions)
{
    const bool chosen = model.shown.show == show;
    if (chosen) {
        ImGui::PushStyleColor(ImGuiCol_Button, colour);
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, colour);
        ImGui::PushStyleColor(ImGuiCol_ButtonActive, colour);
        ImGui::PushStyleColor(ImGuiCol_Text, white_ink);
    }
    if (ImGui::Button(label, { width, 0.0f })) actions.show = show;
    if (chosen) ImGui::PopStyleColor(4);
}

// Buttons for the kind of blend.
void draw_choices(const Overlay& overlay, const HudModel& model, HudActions& actions)
{
    const float s = overlay.scale(), gap = 5.0f * s;
    const float count = model.truth ? 4.0f : 3.0f;
    const float button = (ImGui::GetContentRegionAvail().x - (count - 1.0f) * gap) / count;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, { 2.0f * s, 6.0f * s });
    segment("Elastic", Show::elastic, elastic_ink, model, button, actions);
    ImGui::SameLine(0.0f, gap);
    segment("Linear", Show::linear, linear_ink, model, button, actions);
    ImGui::SameLine(0.0f, gap);
    segment("Both", Show::both, ink, model, button, actions);
    if (model.truth) {
        ImGui::SameLine(0.0f, gap);
        segment("Three", Show::three, unreduced_ink, model, button, actions);
    }
    ImGui::PopStyleVar();
    ImGui::Dummy({ 0.0f, 3.0f * s });
}

// The source of the weights, unless it is the point.
void draw_sources(const Overlay& overlay, const HudModel& model)
{
    if (model.path_frame) {
        char text[48];
        std::snprintf(text, sizeof text, "%.1f of %zu", *model.path_frame, model.path_count);
        row(overlay, "line of the path", text);
    }
    if (!model.shown.truth) return;
    row(overlay, "unreduced average",
        std::to_string(*model.shown.truth + 1) + " of " + std::to_string(model.truth->count()));
    ImGui::PushFont(overlay.small());
    ImGui::PushStyleColor(ImGuiCol_Text, unreduced_ink);
    ImGui::TextUnformatted(model.file.has_layers() ? "all blends use its weights: the rings\non the sliders"
                                                   : "all blends use its weights: the ring\nnearest to the point");
    ImGui::PopStyleColor();
    ImGui::PopFont();
}

// How far the weights of layers lie outside their ranges.
void draw_outside(const Overlay& overlay, float outside)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.2f of a range", outside);
    ImGui::PushStyleColor(ImGuiCol_Text, elastic_ink);
    row(overlay, "outside by", text);
    ImGui::PopStyleColor();
}

// Returns where the panel ends.
float draw_facts(const Overlay& overlay, const HudModel& model, HudActions& actions)
{
    begin_facts(overlay, model.file);
    draw_choices(overlay, model, actions);

    row(overlay, "solve", microseconds(model.solve_us));
    if (model.shown.show == Show::linear) {
        row(overlay, "iterations", "a weighted sum");
    } else {
        const std::string work
            = std::to_string(model.shown.cost.info.iterations) + " / " + std::to_string(model.shown.cost.info.evaluations);
        row(overlay, "iterations / evaluations", work);
        row(overlay, "status", status_text(model.shown.cost.info.status));
        if (model.shown.cost.info.outside > 0.0f) draw_outside(overlay, model.shown.cost.info.outside);
    }
    row(overlay, "reconstruct", microseconds(model.reconstruct_us));
    row(overlay, "normals", microseconds(model.normals_us));
    draw_sources(overlay, model);
    const float end = ImGui::GetWindowPos().y + ImGui::GetWindowHeight();
    ImGui::End();
    return end;
}

// A drag moves the point if it starts off the corners or has left the corner where it started. A click on a corner must
// not move the point, because a double click there travels to the corner.
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
    if (!on_corner || ImGui::IsMouseDragging(ImGuiMouseButton_Left, 6.0f * s))
        actions.drag_to = view.polygon.nearest_inside(view.point(mouse));
}

// Returns where the panel starts.
float draw_polygon_panel(const Overlay& overlay, const HudModel& model, int height, HudActions& actions)
{
    const std::uint32_t count = model.polygon.corner_count();
    const float s = overlay.scale(), top = static_cast<float>(height) - (polygon_height(count) + panel_margin) * s;
    const ImVec2 size { panel_width * s, polygon_height(count) * s };
    ImGui::SetNextWindowPos({ panel_margin * s, top });
    ImGui::SetNextWindowSize(size);
    ImGui::Begin("polygon", nullptr, panel_flags);
    const ImVec2 corner = ImGui::GetWindowPos();
    // Polygons with an odd number of corners have a tip on top, so their centre is a little lower; a line has its labels
    // below.
    const float drop = count == 2 ? -18.0f : count % 2 == 1 ? 12.0f : 2.0f;
    const PolygonView view { model.polygon,
                             model.file.short_names(),
                             { corner.x + size.x * 0.5f, corner.y + size.y * 0.5f + drop * s },
                             polygon_radius(count) * s,
                             0.5f * size.x - 10.0f * s,
                             model.truth };
    ImGui::SetCursorPos({ 6.0f * s, 6.0f * s });
    ImGui::InvisibleButton("inside", { size.x - 12.0f * s, size.y - 12.0f * s });
    handle_polygon_input(view, s, actions);
    draw_polygon(ImGui::GetWindowDrawList(), overlay, view, model.shown.weights, model.point, true);
    ImGui::End();
    return top;
}

std::vector<Key> keys_for(const HudModel& model)
{
    std::vector<Key> keys = { { "drag the point", "blend" }, { "double click a corner, 1-9", "go there" } };
    if (model.file.has_layers()) keys = { { "drag a slider", "blend" }, { "double click", "initial weight" } };
    keys.insert(keys.end(), { { "0", model.file.has_layers() ? "all initial" : "all equal" }, { "S", "sliders" } });
    keys.insert(keys.end(),
                { { "drag the scene, wheel", "turn, zoom" },
                  { "Shift or middle button", "pan" },
                  { "L", "linear / elastic" },
                  { "B", "both" } });
    if (model.truth) keys.emplace_back("T", "three");
    keys.emplace_back("E", model.truth ? "error colours" : "difference colours");
    if (model.has_paint) keys.emplace_back("M", "materials");
    keys.emplace_back("Space", model.path_count > 0 ? "play / pause path" : "play / pause");
    keys.insert(keys.end(), keys_of_all.begin(), keys_of_all.end());
    return keys;
}

} // namespace

HudActions draw_hud(const Overlay& overlay, const HudModel& model, SliderState& sliders, int width, int height)
{
    HudActions actions;
    const float facts_end = draw_facts(overlay, model, actions);
    const bool of_layers = model.file.has_layers();
    const float bottom = of_layers ? static_cast<float>(height) - (panel_margin - panel_gap) * overlay.scale()
                                   : draw_polygon_panel(overlay, model, height, actions);
    const SliderModel shown { model.file.weights(), model.weights, model.truth ? &model.shown.weights : nullptr, of_layers };
    actions.sliders = draw_sliders(overlay, shown, sliders, facts_end, bottom);
    draw_keys(overlay, keys_for(model), model.help, width, height);
    return actions;
}

} // namespace pliant::player
