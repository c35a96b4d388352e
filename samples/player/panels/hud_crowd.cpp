#include "panels/hud_crowd.h"

#include <algorithm>
#include <cstdio>

namespace pliant::player {
namespace {

constexpr float graph_height = 268.0f;
constexpr ImU32 solve_ink = elastic_ink, reconstruct_ink = linear_ink, draw_ink = sand_ink;

std::string kibibytes(std::size_t bytes)
{
    char text[32];
    std::snprintf(text, sizeof text, bytes < 1024 * 1024 ? "%.0f KiB" : "%.1f MiB",
                  static_cast<double>(bytes) / (bytes < 1024 * 1024 ? 1024.0 : 1048576.0));
    return text;
}

void draw_facts(const Overlay& overlay, const CrowdModel& model)
{
    begin_facts(overlay, model.file);
    const std::uint32_t count = model.crowd.count();
    const FrameTime median = model.times.median();
    row(overlay, "characters", grouped(count));
    row(overlay, "blend", model.mode == BlendMode::elastic ? "elastic" : "linear");
    row(overlay, "shapes rebuilt by", model.rebuilder);
    row(overlay, "solve, each", microseconds(median.solve * 1e3 / count));
    if (model.mode == BlendMode::elastic) {
        char evaluations[24];
        std::snprintf(evaluations, sizeof evaluations, "%.1f", static_cast<double>(model.cost.evaluations) / count);
        row(overlay, "evaluations, each", evaluations);
        row(overlay, "memory of all solvers", kibibytes(model.crowd.solver_bytes() * count));
    }
    ImGui::End();
}

void legend_row(const Overlay& overlay, ImU32 colour, const char* label, double value)
{
    const float s = overlay.scale(), side = 11.0f * s;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float down = 0.5f * (ImGui::GetTextLineHeight() - side);
    ImGui::GetWindowDrawList()->AddRectFilled({ at.x, at.y + down }, { at.x + side, at.y + down + side }, colour, 2.5f * s);
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 19.0f * s);
    row(overlay, label, milliseconds(value));
}

// Stacked bars (solve, reconstruct, draw), the newest on the right; lines at half and full axis length.
void draw_bars(const Overlay& overlay, const FrameTimes& times, ImVec2 corner, ImVec2 size)
{
    const float s = overlay.scale();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const double end = axis_end(times.longest());
    for (double share : { 0.0, 0.5, 1.0 }) {
        const float y = corner.y + size.y * static_cast<float>(1.0 - share);
        list->AddLine({ corner.x, y }, { corner.x + size.x, y }, IM_COL32(60, 72, 96, share > 0.0 ? 46 : 120), 1.0f * s);
    }
    const float width = size.x / static_cast<float>(FrameTimes::capacity);
    for (std::size_t age = 0; age < times.count(); ++age) {
        const FrameTime& time = times.frame(age);
        const float right = corner.x + size.x - width * static_cast<float>(age);
        float y = corner.y + size.y;
        for (const auto& [value, colour] : { std::pair<double, ImU32> { time.solve, solve_ink },
                                             { time.reconstruct, reconstruct_ink },
                                             { time.draw, draw_ink } }) {
            const float high = size.y * static_cast<float>(value / end);
            list->AddRectFilled({ right - 0.82f * width, y - high }, { right, y }, colour);
            y -= high;
        }
    }
    for (double share : { 0.5, 1.0 }) {
        char text[24];
        const bool seconds = end >= 1e4; // happens with many characters if the driver renders on the processor
        std::snprintf(text, sizeof text, seconds ? "%g s" : "%g ms", share * end * (seconds ? 1e-3 : 1.0));
        const float y = corner.y + size.y * static_cast<float>(1.0 - share);
        draw_caption(list, overlay.small(), { corner.x + 24.0f * s, y + 2.0f * s }, faint_ink, text);
    }
}

void draw_graph(const Overlay& overlay, const CrowdModel& model, int height)
{
    const float s = overlay.scale();
    ImGui::SetNextWindowPos({ panel_margin * s, static_cast<float>(height) - (graph_height + panel_margin) * s });
    ImGui::SetNextWindowSize({ panel_width * s, graph_height * s });
    ImGui::Begin("graph", nullptr, panel_flags);
    const FrameTime median = model.times.median();
    ImGui::TextUnformatted("frame time");
    ImGui::SameLine();
    ImGui::PushStyleColor(ImGuiCol_Text, faint_ink);
    const std::size_t count = model.times.count();
    ImGui::Text(count == 1 ? "%zu frame" : "last %zu frames", count);
    ImGui::PopStyleColor();
    const ImVec2 corner = ImGui::GetCursorScreenPos(), size { ImGui::GetContentRegionAvail().x, 112.0f * s };
    draw_bars(overlay, model.times, { corner.x, corner.y + 2.0f * s }, size);
    ImGui::Dummy({ size.x, size.y + 8.0f * s });
    legend_row(overlay, draw_ink, "draw", median.draw);
    legend_row(overlay, reconstruct_ink, model.on_gpu ? "rebuild" : "reconstruct, normals", median.reconstruct);
    legend_row(overlay, solve_ink, "solve", median.solve);
    ImGui::End();
}

} // namespace

void draw_crowd_hud(const Overlay& overlay, const CrowdModel& model, int width, int height)
{
    draw_facts(overlay, model);
    draw_graph(overlay, model, height);
    std::vector<Key> keys
        = { { "drag the scene, wheel", "turn, zoom" }, { "Shift or middle button", "pan" }, { "L", "linear / elastic" } };
    if (model.has_paint) keys.emplace_back("M", "materials");
    keys.insert(keys.end(), { { "G", "GPU / CPU" }, { "Space", "play / pause" } });
    keys.insert(keys.end(), keys_of_all.begin(), keys_of_all.end());
    draw_keys(overlay, keys, model.help, width, height);
}

} // namespace pliant::player
