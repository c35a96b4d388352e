#include "panels/polygon_view.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace pliant::player {
namespace {

// Label placement: around the polygon for up to 5 corners; beside it, on two lines for up to 8 and on one line for up to
// 16; above that only for the largest weights.
constexpr std::uint32_t max_corners_around = 5, max_corners_two_lines = 8, max_corners_labelled = 16;
constexpr std::size_t max_labels_of_many = 4;
constexpr double smallest_labelled_weight = 0.005; // smaller weights are shown as 0 %, or omitted on one line
constexpr double large_weight_ratio = 2.0; // in multiples of the mean weight: above 16 poses, smaller weights have no label
constexpr float tint_alpha = 0.55f;

ImVec4 pose_tint(std::uint32_t pose, std::uint32_t pose_count)
{
    ImVec4 colour { 0.0f, 0.0f, 0.0f, 1.0f };
    const float hue = std::fmod(0.03f + static_cast<float>(pose) / static_cast<float>(pose_count), 1.0f);
    ImGui::ColorConvertHSVtoRGB(hue, 0.52f, 0.93f, colour.x, colour.y, colour.z);
    return colour;
}

// The poses' colours, mixed by the weights.
ImU32 mixed_colour(const std::vector<double>& weights, float alpha)
{
    ImVec4 sum { 0.0f, 0.0f, 0.0f, alpha };
    for (std::uint32_t k = 0; k < weights.size(); ++k) {
        const ImVec4 tint = pose_tint(k, static_cast<std::uint32_t>(weights.size()));
        const auto weight = static_cast<float>(weights[k]);
        sum.x += weight * tint.x;
        sum.y += weight * tint.y;
        sum.z += weight * tint.z;
    }
    return ImGui::ColorConvertFloat4ToU32(sum);
}

// Fills the polygon with the mixed colours: rings of quads around the centre, with exact colours at their corners.
void draw_tint(ImDrawList* list, const PolygonView& view)
{
    const std::uint32_t corners = view.polygon.corner_count();
    const std::uint32_t steps = std::max(1u, 40u / corners), segments = corners * steps, rings = 9;
    const auto at = [&](std::uint32_t ring, std::uint32_t segment) {
        const std::uint32_t edge = segment / steps % corners;
        const double along = static_cast<double>(segment % steps) / steps;
        const auto& c = view.polygon.corners();
        const glm::dvec2 outside = (1.0 - along) * c[edge] + along * c[(edge + 1) % corners];
        return outside * (static_cast<double>(ring) / rings);
    };
    list->PrimReserve(static_cast<int>(6 * rings * segments), static_cast<int>((rings + 1) * segments));
    const unsigned first = list->_VtxCurrentIdx;
    const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
    for (std::uint32_t ring = 0; ring <= rings; ++ring) {
        for (std::uint32_t segment = 0; segment < segments; ++segment) {
            const glm::dvec2 point = at(ring, segment);
            list->PrimWriteVtx(view.place(point), white, mixed_colour(view.polygon.weights(point), tint_alpha));
        }
    }
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
        for (std::uint32_t segment = 0; segment < segments; ++segment) {
            const unsigned a = first + ring * segments + segment, b = first + ring * segments + (segment + 1) % segments;
            for (unsigned index : { a, b, b + segments, a, b + segments, a + segments })
                list->PrimWriteIdx(static_cast<ImDrawIdx>(index));
        }
    }
}

void draw_truth_marks(ImDrawList* list, const PolygonView& view, const std::vector<double>& weights, float s)
{
    for (std::size_t i = 0; i < view.truth->count(); ++i) {
        const ImVec2 at = view.place(view.polygon.point(view.truth->weights(i)));
        list->AddCircleFilled(at, 2.6f * s, IM_COL32(255, 255, 255, 230), 12);
        list->AddCircleFilled(at, 1.5f * s, unreduced_ink, 12);
    }
    const ImVec2 shown = view.place(view.polygon.point(weights));
    list->AddCircle(shown, 14.5f * s, IM_COL32(255, 255, 255, 255), 32, 5.0f * s);
    list->AddCircle(shown, 14.5f * s, unreduced_ink, 32, 2.6f * s);
}

std::string percentage(double weight)
{
    char text[16];
    std::snprintf(text, sizeof text, "%.0f %%", 100.0 * weight);
    return text;
}

// A name and a weight around `place`; a name that is wider than the room on either side of it is cut in its middle.
void draw_label(ImDrawList* list, const Overlay& overlay, const PolygonView& view, std::uint32_t corner, double weight)
{
    const glm::dvec2 outward = view.polygon.corners()[corner];
    const float s = overlay.scale(), x = static_cast<float>(outward.x), y = static_cast<float>(outward.y);
    const ImVec2 at = view.place(outward);
    ImVec2 place { at.x + x * 14.0f * s, at.y - y * 16.0f * s };
    float right = 0.5f; // the share of the text to the right of `place`, if the corner is on the right
    if (view.polygon.corner_count() == 2) {
        place = { at.x + x * 8.0f * s, at.y + 18.0f * s };
        right = 0.0f;
    } else if (std::abs(x) > 0.35f && y > -0.45f) { // excludes the lower corners of a triangle, at -0.5
        // There is little room beside the polygon: the two lines stand above the corner and are shifted inwards.
        right = 0.38f;
        place.y = at.y - 48.0f * s;
    } else if (y > 0.5f) {
        place.y -= 26.0f * s;
    }
    const float aside = std::abs(place.x - view.centre.x);
    float room = 2.0f * view.room;
    if (aside > s) room = std::min((view.room - aside) / std::max(right, 1e-3f), (aside - 3.0f * s) / (1.0f - right));
    const std::string name = elided(overlay.text(), view.names[corner], room);
    const ImVec2 anchor { x > 0.0f ? 1.0f - right : right, 0.0f };
    draw_text(list, overlay.text(), place, anchor, ink, name);
    draw_text(list, overlay.small(), { place.x, place.y + 17.0f * s }, anchor, faint_ink, percentage(weight));
}

// A label beside its corner that grows outwards to the edge of the panel; above or below corners in the middle.
class SideLabel {
public:
    SideLabel(const Overlay& overlay, const PolygonView& view, std::uint32_t corner, double weight, bool two_lines)
        : overlay_(overlay)
        , second_(two_lines ? percentage(weight) : "")
    {
        const float s = overlay.scale(), gap = 12.0f * s, line = overlay.small()->FontSize;
        const glm::dvec2 outward = view.polygon.corners()[corner];
        const ImVec2 at = view.place(outward);
        const float side = std::abs(outward.x) < 0.2 ? 0.0f : outward.x > 0.0 ? 1.0f : -1.0f;
        const float room = side == 0.0f ? 2.0f * view.room : view.room - std::abs(at.x - view.centre.x) - gap;
        const std::string tail = two_lines || weight < smallest_labelled_weight ? "" : " · " + percentage(weight);
        const float tail_width = overlay.small()->CalcTextSizeA(line, FLT_MAX, 0.0f, tail.c_str()).x;
        first_ = elided(overlay.small(), view.names[corner], room - tail_width) + tail;
        anchor_ = 0.5f - 0.5f * side;
        size_ = overlay.small()->CalcTextSizeA(line, FLT_MAX, 0.0f, first_.c_str());
        size_.y = two_lines ? 2.0f * line : line;
        place_ = { at.x + side * gap, at.y - 0.5f * size_.y };
        if (side == 0.0f) place_.y += (outward.y > 0.0 ? -1.0f : 1.0f) * (gap + 0.5f * size_.y);
    }

    bool overlaps(const SideLabel& other) const
    {
        const float left = place_.x - anchor_ * size_.x, other_left = other.place_.x - other.anchor_ * other.size_.x;
        return left < other_left + other.size_.x && other_left < left + size_.x && place_.y < other.place_.y + other.size_.y
            && other.place_.y < place_.y + size_.y;
    }

    void draw(ImDrawList* list, double weight) const
    {
        draw_text(list, overlay_.small(), place_, { anchor_, 0.0f }, weight < smallest_labelled_weight ? faint_ink : ink,
                  first_);
        if (second_.empty()) return;
        const ImVec2 below { place_.x, place_.y + 0.5f * size_.y };
        draw_text(list, overlay_.small(), below, { anchor_, 0.0f }, faint_ink, second_);
    }

private:
    const Overlay& overlay_;
    std::string first_, second_;
    ImVec2 place_, size_;
    float anchor_;
};

// For many poses: labels of the largest weights, as long as they do not overlap.
void draw_largest_labels(ImDrawList* list, const Overlay& overlay, const PolygonView& view,
                         const std::vector<double>& weights)
{
    std::vector<std::uint32_t> order(weights.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return weights[a] > weights[b]; });
    std::vector<SideLabel> drawn;
    for (std::uint32_t k : order) {
        if (weights[k] * static_cast<double>(weights.size()) < large_weight_ratio || drawn.size() == max_labels_of_many)
            break;
        const SideLabel label(overlay, view, k, weights[k], false);
        bool is_free = true;
        for (const SideLabel& other : drawn) is_free = is_free && !label.overlaps(other);
        if (!is_free) continue;
        label.draw(list, weights[k]);
        drawn.push_back(label);
    }
}

void draw_labels(ImDrawList* list, const Overlay& overlay, const PolygonView& view, const std::vector<double>& weights)
{
    const std::uint32_t count = view.polygon.corner_count();
    if (count > max_corners_labelled) {
        draw_largest_labels(list, overlay, view, weights);
        return;
    }
    for (std::uint32_t k = 0; k < count; ++k) {
        if (count <= max_corners_around) {
            draw_label(list, overlay, view, k, weights[k]);
        } else {
            SideLabel(overlay, view, k, weights[k], count <= max_corners_two_lines).draw(list, weights[k]);
        }
    }
}

// Of more than three poses, most weights are not those of any point.
bool are_weights_of(const ControlPolygon& polygon, glm::dvec2 point, const std::vector<double>& weights)
{
    const std::vector<double> own = polygon.weights(point);
    for (std::size_t k = 0; k < own.size(); ++k)
        if (std::abs(own[k] - weights[k]) > smallest_labelled_weight) return false;
    return true;
}

} // namespace

float polygon_radius(std::uint32_t pose_count)
{
    return pose_count == 2 ? 128.0f : pose_count <= max_corners_around ? 96.0f : 78.0f;
}

ImU32 pose_colour(std::uint32_t pose, std::uint32_t pose_count, float alpha)
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

std::optional<std::uint32_t> PolygonView::corner_at(ImVec2 place_on_screen, float reach) const
{
    for (std::uint32_t k = 0; k < polygon.corner_count(); ++k) {
        const ImVec2 corner = place(polygon.corners()[k]);
        if (std::hypot(corner.x - place_on_screen.x, corner.y - place_on_screen.y) <= reach) return k;
    }
    return std::nullopt;
}

void draw_polygon(ImDrawList* list, const Overlay& overlay, const PolygonView& view, const std::vector<double>& weights,
                  glm::dvec2 point, bool with_labels)
{
    const float s = overlay.scale() * std::min(1.0f, view.radius / (90.0f * overlay.scale()));
    const std::uint32_t count = view.polygon.corner_count();
    std::vector<ImVec2> outline;
    for (const glm::dvec2& corner : view.polygon.corners()) outline.push_back(view.place(corner));
    if (count > 2) draw_tint(list, view);
    list->AddPolyline(outline.data(), static_cast<int>(count), IM_COL32(255, 255, 255, 255), ImDrawFlags_Closed, 4.0f * s);
    list->AddPolyline(outline.data(), static_cast<int>(count), IM_COL32(60, 72, 96, 150), ImDrawFlags_Closed, 1.6f * s);
    for (std::uint32_t k = 0; k < count; ++k) {
        const ImVec2 corner = view.place(view.polygon.corners()[k]);
        const float share = static_cast<float>(weights[k]);
        list->AddLine(view.place(point), corner, IM_COL32(60, 72, 96, static_cast<int>(25 + 150 * share)),
                      (1.0f + 2.0f * share) * s);
    }
    const float dot = s * (count <= max_corners_labelled ? 5.5f : 3.0f); // small enough for 64 separate corners
    for (std::uint32_t k = 0; k < count; ++k) {
        const ImVec2 corner = view.place(view.polygon.corners()[k]);
        list->AddCircleFilled(corner, dot * 1.36f, IM_COL32(255, 255, 255, 255), 24);
        list->AddCircleFilled(corner, dot, pose_colour(k, count, 1.0f), 24);
    }
    if (view.truth) draw_truth_marks(list, view, weights, s);
    const ImVec2 handle = view.place(point);
    list->AddCircleFilled({ handle.x, handle.y + 1.5f * s }, 12.5f * s, IM_COL32(20, 28, 44, 50), 32);
    list->AddCircleFilled(handle, 11.0f * s, IM_COL32(255, 255, 255, 255), 32);
    list->AddCircleFilled(handle, 8.0f * s, ink, 32);
    if (!view.truth && !are_weights_of(view.polygon, point, weights))
        list->AddCircleFilled(handle, 5.0f * s, IM_COL32(255, 255, 255, 255), 32);
    if (with_labels) draw_labels(list, overlay, view, weights);
}

} // namespace pliant::player
