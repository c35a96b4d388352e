#include "panels/hud_heat.h"

#include "panels/hud_parts.h"

#include <algorithm>
#include <cmath>

namespace pliant::player {
namespace {

// In pixels of the design.
constexpr float legend_height = 76.0f;
float caption_height(const Shown& shown) { return shown.heat ? 60.0f : 40.0f; }

bool has_captions(const Shown& shown) { return shown.heat || kinds_of(shown.show).size() > 1; }

ImU32 ink_of(Kind kind) { return kind == Kind::linear ? linear_ink : kind == Kind::elastic ? elastic_ink : unreduced_ink; }

ImU32 heat_ink(std::size_t stop)
{
    const glm::vec3 c = heat_colours[stop] * 255.0f;
    return IM_COL32(static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z), 255);
}

std::string distances(const Shown& shown, Kind kind)
{
    if (kind == Kind::unreduced) return "the reference, hatched";
    const HeatSummary& heat = kind == Kind::linear ? shown.linear_heat : shown.elastic_heat;
    return "mean " + percent(heat.mean) + ", largest " + percent(heat.largest);
}

} // namespace

Area without_captions(const Shown& shown, Area free, float scale)
{
    const float above = shown.heat ? legend_height * scale : 0.0f;
    const float below = has_captions(shown) ? caption_height(shown) * scale : 0.0f;
    free.y += above;
    free.height = std::max(free.height - above - below, 1.0f);
    return free;
}

void draw_side_captions(const Overlay& overlay, const Shown& shown, const Area& free, const std::vector<glm::vec2>& places)
{
    if (!has_captions(shown)) return;
    const std::vector<Kind> kinds = kinds_of(shown.show);
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const float s = overlay.scale(), lowest = free.y + free.height - caption_height(shown) * s;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const float x = std::clamp(places[i].x, free.x, free.x + free.width);
        const float y = std::clamp(places[i].y, free.y, lowest) + 8.0f * s;
        draw_caption(list, overlay.title(), { x, y }, ink_of(kinds[i]), name_of(kinds[i]));
        if (shown.heat) draw_caption(list, overlay.small(), { x, y + 29.0f * s }, faint_ink, distances(shown, kinds[i]));
    }
}

void draw_heat_legend(const Overlay& overlay, const Shown& shown, const Area& free)
{
    if (!shown.heat) return;
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const float s = overlay.scale(), width = std::min(340.0f * s, 0.8f * free.width), height = 12.0f * s;
    const ImVec2 corner { free.x + 0.5f * (free.width - width), free.y + 44.0f * s };
    const std::string title
        = std::string(shown.truth ? "distance from the unreduced average" : "distance between linear and elastic")
        + ", fraction of the diagonal";
    list->AddRectFilled({ corner.x - 42.0f * s, corner.y - 32.0f * s },
                        { corner.x + width + 42.0f * s, corner.y + 40.0f * s }, panel, 10.0f * s);
    draw_text(list, overlay.small(), { corner.x + 0.5f * width, corner.y - 8.0f * s }, { 0.5f, 1.0f }, ink, title);
    const float step = width / static_cast<float>(heat_colours.size() - 1);
    for (std::size_t i = 0; i + 1 < heat_colours.size(); ++i) {
        const float left = corner.x + step * static_cast<float>(i);
        const ImU32 from = heat_ink(i), to = heat_ink(i + 1);
        list->AddRectFilledMultiColor({ left, corner.y }, { left + step, corner.y + height }, from, to, to, from);
    }
    list->AddRect(corner, { corner.x + width, corner.y + height }, IM_COL32(60, 72, 96, 130), 0.0f, 0, 1.0f * s);
    // A mark at every power of ten; the ends of the scale are powers of ten.
    const int decades = static_cast<int>(std::lround(std::log10(highest_heat / lowest_heat)));
    for (int i = 0; i <= decades; ++i) {
        const double share = static_cast<double>(lowest_heat) * std::pow(10.0, i);
        const float x = corner.x + width * static_cast<float>(i) / static_cast<float>(decades);
        list->AddLine({ x, corner.y + height }, { x, corner.y + height + 5.0f * s }, IM_COL32(60, 72, 96, 200), 1.2f * s);
        char text[16];
        std::snprintf(text, sizeof text, "%g %%", 100.0 * static_cast<double>(static_cast<float>(share)));
        std::string mark = i == 0 ? std::string("≤ ") + text : i == decades ? std::string("≥ ") + text : text;
        draw_text(list, overlay.small(), { x, corner.y + height + 7.0f * s }, { 0.5f, 0.0f }, faint_ink, mark);
    }
}

} // namespace pliant::player
