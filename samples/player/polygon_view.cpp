#include "polygon_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::player {

namespace {

constexpr uint32_t kMostLabels = 16;
constexpr float kTint = 0.55f;

ImVec4 pose_tint(uint32_t pose, uint32_t pose_count)
{
    ImVec4 colour { 0.0f, 0.0f, 0.0f, 1.0f };
    const float hue = std::fmod(0.03f + static_cast<float>(pose) / static_cast<float>(pose_count), 1.0f);
    ImGui::ColorConvertHSVtoRGB(hue, 0.52f, 0.93f, colour.x, colour.y, colour.z);
    return colour;
}

// The poses' colours, mixed by weights.
ImU32 mixed_colour(const std::vector<double>& weights, float alpha)
{
    ImVec4 sum { 0.0f, 0.0f, 0.0f, alpha };
    for (uint32_t k = 0; k < weights.size(); ++k) {
        const ImVec4 tint = pose_tint(k, static_cast<uint32_t>(weights.size()));
        const auto weight = static_cast<float>(weights[k]);
        sum.x += weight * tint.x;
        sum.y += weight * tint.y;
        sum.z += weight * tint.z;
    }
    return ImGui::ColorConvertFloat4ToU32(sum);
}

// Fills the polygon with the mixed colours: rings of quads around the centre, colours exact at their corners.
void draw_tint(ImDrawList* list, const PolygonView& view)
{
    const uint32_t corners = view.polygon.corner_count();
    const uint32_t steps = std::max(1u, 40u / corners), segments = corners * steps, rings = 9;
    const auto at = [&](uint32_t ring, uint32_t segment) {
        const uint32_t edge = segment / steps % corners;
        const double along = static_cast<double>(segment % steps) / steps;
        const auto& c = view.polygon.corners();
        const glm::dvec2 outside = (1.0 - along) * c[edge] + along * c[(edge + 1) % corners];
        return outside * (static_cast<double>(ring) / rings);
    };
    list->PrimReserve(static_cast<int>(6 * rings * segments), static_cast<int>((rings + 1) * segments));
    const unsigned first = list->_VtxCurrentIdx;
    const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
    for (uint32_t ring = 0; ring <= rings; ++ring) {
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const glm::dvec2 point = at(ring, segment);
            list->PrimWriteVtx(view.place(point), white, mixed_colour(view.polygon.weights(point), kTint));
        }
    }
    for (uint32_t ring = 0; ring < rings; ++ring) {
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const unsigned a = first + ring * segments + segment, b = first + ring * segments + (segment + 1) % segments;
            for (unsigned index : { a, b, b + segments, a, b + segments, a + segments }) {
                list->PrimWriteIdx(static_cast<ImDrawIdx>(index));
            }
        }
    }
}

void draw_truth_marks(ImDrawList* list, const PolygonView& view, const std::vector<double>& weights, float s)
{
    for (size_t i = 0; i < view.truth->count(); ++i) {
        const ImVec2 at = view.place(view.polygon.point(view.truth->weights(i)));
        list->AddCircleFilled(at, 2.6f * s, IM_COL32(255, 255, 255, 230), 12);
        list->AddCircleFilled(at, 1.5f * s, kUnreducedInk, 12);
    }
    const ImVec2 shown = view.place(view.polygon.point(weights));
    list->AddCircle(shown, 14.5f * s, IM_COL32(255, 255, 255, 255), 32, 5.0f * s);
    list->AddCircle(shown, 14.5f * s, kUnreducedInk, 32, 2.6f * s);
}

// Labels grow away from the centre, and stay inside the panel by shortening.
void draw_label(ImDrawList* list, const Overlay& overlay, const PolygonView& view, uint32_t corner, double weight)
{
    const glm::dvec2 outward = view.polygon.corners()[corner];
    const float s = overlay.scale();
    const ImVec2 at = view.place(outward);
    std::string name = view.names[corner];
    if (name.size() > 14) name = name.substr(0, 13) + "…";
    char percent[16];
    std::snprintf(percent, sizeof percent, "%.0f %%", 100.0 * weight);

    const bool beside = view.polygon.corner_count() > 2 && std::abs(outward.x) > 0.35;
    const float line = 17.0f * s;
    ImVec2 place { at.x + static_cast<float>(outward.x) * 14.0f * s, at.y - static_cast<float>(outward.y) * 16.0f * s };
    float anchor = 0.5f;
    if (beside && outward.y > -0.5) {
        // Beside the polygon there is little room: the two lines stand above or below the corner, growing inwards if need be.
        anchor = outward.x > 0.0 ? 0.62f : 0.38f;
        place.y = at.y - 48.0f * s;
    } else if (outward.y > 0.5) {
        place.y -= 26.0f * s;
    } else if (view.polygon.corner_count() == 2) {
        place.y += 14.0f * s;
        place.x = at.x;
    }
    draw_text(list, overlay.text(), place, { anchor, 0.0f }, kInk, name);
    draw_text(list, overlay.small(), { place.x, place.y + line }, { anchor, 0.0f }, kFaintInk, percent);
}

} // namespace

ImU32 pose_colour(uint32_t pose, uint32_t pose_count, float alpha)
{
    ImVec4 tint = pose_tint(pose, pose_count);
    tint.w = alpha;
    return ImGui::ColorConvertFloat4ToU32(tint);
}

ImVec2 PolygonView::place(glm::dvec2 point) const
{
    return { centre.x + static_cast<float>(point.x) * radius, centre.y - static_cast<float>(point.y) * radius };
}

glm::dvec2 PolygonView::point(ImVec2 place) const
{
    return { (place.x - centre.x) / radius, (centre.y - place.y) / radius };
}

std::optional<uint32_t> PolygonView::corner_at(ImVec2 place_on_screen, float reach) const
{
    for (uint32_t k = 0; k < polygon.corner_count(); ++k) {
        const ImVec2 corner = place(polygon.corners()[k]);
        if (std::hypot(corner.x - place_on_screen.x, corner.y - place_on_screen.y) <= reach) return k;
    }
    return std::nullopt;
}

void draw_polygon(ImDrawList* list, const Overlay& overlay, const PolygonView& view, const std::vector<double>& weights,
                  glm::dvec2 point, bool with_labels)
{
    const float s = overlay.scale() * std::min(1.0f, view.radius / (90.0f * overlay.scale()));
    const uint32_t count = view.polygon.corner_count();
    std::vector<ImVec2> outline;
    for (const glm::dvec2& corner : view.polygon.corners()) outline.push_back(view.place(corner));
    if (count > 2) draw_tint(list, view);
    list->AddPolyline(outline.data(), static_cast<int>(count), IM_COL32(255, 255, 255, 255), ImDrawFlags_Closed, 4.0f * s);
    list->AddPolyline(outline.data(), static_cast<int>(count), IM_COL32(60, 72, 96, 150), ImDrawFlags_Closed, 1.6f * s);
    for (uint32_t k = 0; k < count; ++k) {
        const ImVec2 corner = view.place(view.polygon.corners()[k]);
        const float share = static_cast<float>(weights[k]);
        list->AddLine(view.place(point), corner, IM_COL32(60, 72, 96, static_cast<int>(25 + 150 * share)),
                      (1.0f + 2.0f * share) * s);
    }
    for (uint32_t k = 0; k < count; ++k) {
        const ImVec2 corner = view.place(view.polygon.corners()[k]);
        list->AddCircleFilled(corner, 7.5f * s, IM_COL32(255, 255, 255, 255), 24);
        list->AddCircleFilled(corner, 5.5f * s, pose_colour(k, count, 1.0f), 24);
    }
    if (view.truth) draw_truth_marks(list, view, weights, s);
    const ImVec2 handle = view.place(point);
    list->AddCircleFilled({ handle.x, handle.y + 1.5f * s }, 12.5f * s, IM_COL32(20, 28, 44, 50), 32);
    list->AddCircleFilled(handle, 11.0f * s, IM_COL32(255, 255, 255, 255), 32);
    list->AddCircleFilled(handle, 8.0f * s, kInk, 32);
    if (with_labels && count <= kMostLabels) {
        for (uint32_t k = 0; k < count; ++k) draw_label(list, overlay, view, k, weights[k]);
    }
}

} // namespace pliant::player
