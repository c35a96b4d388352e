#include "panels/sliders.h"

#include "panels/hud_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::player {
namespace {

constexpr std::size_t most_without_search = 12;
constexpr std::size_t most_on_two_lines = 8; // further layers have name, slider and weight on one line

// Sizes in pixels of the design.
constexpr float head_height = 46.0f, search_height = 36.0f;
constexpr float high_row = 46.0f, low_row = 27.0f, shortest_list = 100.0f;
constexpr float name_width = 104.0f, value_width = 40.0f, handle_radius = 7.5f;

constexpr ImU32 track_ink = IM_COL32(60, 72, 96, 60), range_ink = IM_COL32(88, 108, 142, 190);

// The weights that a slider offers.
struct Reach {
    double from, to;

    explicit Reach(const LayerWeight& layer)
        : from(layer.low - 0.5 * (layer.high - layer.low))
        , to(layer.high + 0.5 * (layer.high - layer.low))
    {
    }
    double share(double weight) const { return std::clamp((weight - from) / std::max(to - from, 1e-30), 0.0, 1.0); }
    double weight(double share) const { return from + std::clamp(share, 0.0, 1.0) * (to - from); }
};

// Where the parts of a row are, on the screen.
struct RowPlace {
    ImVec2 name;
    float name_room, value_right, text_y, left, right, y;

    RowPlace(const Overlay& overlay, ImVec2 corner, float width, bool two_lines)
    {
        const float s = overlay.scale(), radius = handle_radius * s, line = overlay.small()->FontSize;
        value_right = corner.x + width;
        text_y = two_lines ? corner.y + 3.0f * s : corner.y + 0.5f * (low_row * s - line);
        name = { corner.x, text_y };
        name_room = two_lines ? width - (value_width + 8.0f) * s : name_width * s;
        left = two_lines ? corner.x + radius : corner.x + (name_width + 8.0f) * s + radius;
        right = two_lines ? corner.x + width - radius : corner.x + width - value_width * s - radius;
        y = std::floor(two_lines ? corner.y + 31.0f * s : corner.y + 0.5f * low_row * s);
    }
    float at(double share) const { return left + static_cast<float>(share) * (right - left); }
};

std::string number(double weight)
{
    char text[32];
    std::snprintf(text, sizeof text, std::abs(weight) < 99.995 ? "%.2f" : "%.3g", weight);
    return std::string(text) == "-0.00" ? "0.00" : text;
}

bool contains(const std::string& name, const char* wanted)
{
    const std::string text(wanted);
    return std::search(name.begin(), name.end(), text.begin(), text.end(),
                       [](char a, char b) {
                           return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
                       })
        != name.end();
}

void draw_track(ImDrawList* list, const LayerWeight& layer, const RowPlace& place, float s)
{
    const Reach reach(layer);
    list->AddLine({ place.left, place.y }, { place.right, place.y }, track_ink, std::max(3.0f * s, 1.0f));
    const float low = place.at(reach.share(layer.low)), high = place.at(reach.share(layer.high));
    list->AddLine({ low, place.y }, { high, place.y }, range_ink, 6.0f * s);
    const float initial = place.at(reach.share(layer.initial));
    list->AddLine({ initial, place.y - 7.0f * s }, { initial, place.y + 7.0f * s }, ink, 1.5f * s);
}

void draw_handle(ImDrawList* list, float x, float y, ImU32 colour, float s)
{
    list->AddCircleFilled({ x, y + 1.0f * s }, (handle_radius + 1.0f) * s, IM_COL32(20, 28, 44, 45), 24);
    list->AddCircleFilled({ x, y }, handle_radius * s, IM_COL32(255, 255, 255, 255), 24);
    list->AddCircleFilled({ x, y }, (handle_radius - 2.5f) * s, colour, 24);
}

// A weight outside its range has the colour of a warning.
void draw_row(const Overlay& overlay, const SliderModel& model, std::uint32_t k, const RowPlace& place)
{
    const LayerWeight& layer = model.layers[k];
    const double weight = model.weights[k];
    const float s = overlay.scale();
    const bool is_outside = weight < layer.low || weight > layer.high;
    ImDrawList* list = ImGui::GetWindowDrawList();
    draw_track(list, layer, place, s);
    draw_handle(list, place.at(Reach(layer).share(weight)), place.y, is_outside ? elastic_ink : ink, s);
    if (model.truth)
        list->AddCircle({ place.at(Reach(layer).share((*model.truth)[k])), place.y }, 9.5f * s, unreduced_ink, 24, 2.0f * s);
    draw_text(list, overlay.small(), place.name, {}, ink, elided(overlay.small(), layer.name, place.name_room));
    draw_text(list, overlay.small(), { place.value_right, place.text_y }, { 1.0f, 0.0f },
              is_outside ? elastic_ink : faint_ink, number(weight));
}

std::string described(const LayerWeight& layer)
{
    return layer.name + ": measured from " + number(layer.low) + " to " + number(layer.high) + ", initially "
        + number(layer.initial);
}

// The whole row is the slider's: a double click anywhere in it resets, a drag that starts at the track moves the weight.
void handle_row(const SliderModel& model, std::uint32_t k, const RowPlace& place, SliderActions& actions)
{
    const LayerWeight& layer = model.layers[k];
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        actions.weights.emplace_back(k, layer.initial);
        return;
    }
    if (ImGui::IsItemHovered() && !ImGui::IsItemActive()) ImGui::SetTooltip("%s", described(layer).c_str());
    if (!ImGui::IsItemActive() || place.right <= place.left) return;
    const ImGuiIO& io = ImGui::GetIO();
    const ImVec2 start = io.MouseClickedPos[ImGuiMouseButton_Left];
    const float handle = place.at(Reach(layer).share(model.weights[k]));
    const bool at_track = start.x >= place.left - 8.0f && start.x <= place.right + 8.0f && start.y >= place.text_y;
    // A click on the handle must not move it: it may be the first half of a double click.
    const bool rests = std::abs(start.x - handle) < 9.0f && !ImGui::IsMouseDragging(ImGuiMouseButton_Left, 2.0f);
    if (!at_track || rests) return;
    actions.weights.emplace_back(k, Reach(layer).weight((io.MousePos.x - place.left) / (place.right - place.left)));
}

void draw_head(const Overlay& overlay, const SliderModel& model, SliderSearch& search, SliderActions& actions)
{
    const float s = overlay.scale(), button = 88.0f * s;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, { 2.0f * s, 4.0f * s });
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("layers");
    ImGui::SameLine(ImGui::GetWindowWidth() - 18.0f * s - button);
    if (ImGui::Button("Reset all", { button, 0.0f })) actions.reset_all = true;
    ImGui::PopStyleVar();
    if (model.layers.size() <= most_without_search) return;
    ImGui::PushFont(overlay.small());
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    ImGui::InputTextWithHint("##search", "search", search.text.data(), search.text.size());
    ImGui::PopFont();
}

void draw_list(const Overlay& overlay, const SliderModel& model, const std::vector<std::uint32_t>& found,
               SliderActions& actions)
{
    const bool two_lines = model.layers.size() <= most_on_two_lines;
    const float s = overlay.scale(), height = (two_lines ? high_row : low_row) * s;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, { 0.0f, 0.0f });
    ImGui::BeginChild("list", { 0.0f, 0.0f }, false, ImGuiWindowFlags_NoNav);
    const float width = ImGui::GetContentRegionAvail().x;
    for (std::uint32_t k : found) {
        const RowPlace place(overlay, ImGui::GetCursorScreenPos(), width - 2.0f * s, two_lines);
        ImGui::PushID(static_cast<int>(k));
        ImGui::InvisibleButton("slider", { width, height });
        ImGui::PopID();
        handle_row(model, k, place, actions);
        draw_row(overlay, model, k, place);
    }
    if (found.empty()) ImGui::TextUnformatted("no layer has this name");
    ImGui::EndChild();
    ImGui::PopStyleVar();
}

std::vector<std::uint32_t> found_layers(const SliderModel& model, const SliderSearch& search)
{
    std::vector<std::uint32_t> found;
    for (std::uint32_t k = 0; k < model.layers.size(); ++k)
        if (contains(model.layers[k].name, search.text.data())) found.push_back(k);
    return found;
}

} // namespace

SliderActions draw_sliders(const Overlay& overlay, const SliderModel& model, SliderSearch& search, float top, float bottom)
{
    SliderActions actions;
    const float s = overlay.scale(), row = model.layers.size() <= most_on_two_lines ? high_row : low_row;
    const float frame = head_height + 26.0f + (model.layers.size() > most_without_search ? search_height : 0.0f);
    const float room = (bottom - top) / s - 2.0f * panel_margin;
    const float wanted = frame + row * static_cast<float>(model.layers.size());
    const float height = std::max(std::min(wanted, room), frame + shortest_list);
    ImGui::SetNextWindowPos({ panel_margin * s, bottom - (height + panel_margin) * s });
    ImGui::SetNextWindowSize({ panel_width * s, height * s });
    ImGui::Begin("sliders", nullptr, panel_flags);
    draw_head(overlay, model, search, actions);
    draw_list(overlay, model, found_layers(model, search), actions);
    ImGui::End();
    return actions;
}

} // namespace pliant::player
