#include "panels/sliders.h"

#include "blend/weight_path.h"
#include "panels/hud_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::player {
namespace {

constexpr int frames_to_settle = 3; // until panels that fit their contents have their size
constexpr std::size_t most_without_search = 12;
constexpr std::size_t most_on_two_lines = 8; // further layers, and all poses, have name, slider and weight on one line

// Sizes in pixels of the design.
constexpr float head_height = 52.0f, search_height = 36.0f;
constexpr float high_row = 46.0f, low_row = 27.0f, shortest_list = 100.0f;
constexpr float name_width = 104.0f, value_width = 40.0f, handle_radius = 7.5f;

constexpr ImU32 track_ink = IM_COL32(60, 72, 96, 60), range_ink = IM_COL32(88, 108, 142, 190);

// The weights that a slider offers.
struct Reach {
    double from, to;

    Reach(const SliderModel& model, std::uint32_t k)
    {
        const WeightRange& range = model.ranges[k];
        const double beyond = model.of_layers ? 0.5 * (range.high - range.low) : 0.0;
        from = range.low - beyond;
        to = range.high + beyond;
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

bool on_two_lines(const SliderModel& model) { return model.of_layers && model.ranges.size() <= most_on_two_lines; }

void draw_track(ImDrawList* list, const WeightRange& range, const Reach& reach, const RowPlace& place, float s)
{
    list->AddLine({ place.left, place.y }, { place.right, place.y }, track_ink, std::max(3.0f * s, 1.0f));
    const float low = place.at(reach.share(range.low)), high = place.at(reach.share(range.high));
    list->AddLine({ low, place.y }, { high, place.y }, range_ink, 6.0f * s);
    const float initial = place.at(reach.share(range.initial));
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
    const WeightRange& range = model.ranges[k];
    const Reach reach(model, k);
    const double weight = model.weights[k];
    const float s = overlay.scale();
    const bool is_outside = model.of_layers && (weight < range.low || weight > range.high);
    ImDrawList* list = ImGui::GetWindowDrawList();
    draw_track(list, range, reach, place, s);
    draw_handle(list, place.at(reach.share(weight)), place.y, is_outside ? elastic_ink : ink, s);
    if (model.truth)
        list->AddCircle({ place.at(reach.share((*model.truth)[k])), place.y }, 9.5f * s, unreduced_ink, 24, 2.0f * s);
    draw_text(list, overlay.small(), place.name, {}, ink, elided(overlay.small(), range.name, place.name_room));
    draw_text(list, overlay.small(), { place.value_right, place.text_y }, { 1.0f, 0.0f },
              is_outside ? elastic_ink : faint_ink, number(weight));
}

std::string described(const SliderModel& model, const WeightRange& range)
{
    const std::string measured
        = ": measured from " + number(range.low) + " to " + number(range.high) + ", initially " + number(range.initial);
    return range.name + (model.of_layers ? measured : "") + "\nCtrl-click to type a number";
}

// The whole row is the slider's: a double click anywhere in it resets, a click with Ctrl lets a number be typed, a drag that
// starts at the track moves the weight.
void handle_row(const SliderModel& model, std::uint32_t k, const RowPlace& place, SliderState& state, SliderActions& actions)
{
    const WeightRange& range = model.ranges[k];
    const Reach reach(model, k);
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemClicked() && io.KeyCtrl) {
        state.typed = k;
        state.wants_focus = true;
        std::snprintf(state.number.data(), state.number.size(), "%.6g", model.weights[k]);
        return;
    }
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        actions.weights.emplace_back(k, range.initial);
        return;
    }
    if (ImGui::IsItemHovered() && !ImGui::IsItemActive()) ImGui::SetTooltip("%s", described(model, range).c_str());
    if (!ImGui::IsItemActive() || place.right <= place.left || state.typed == k) return;
    const ImVec2 start = io.MouseClickedPos[ImGuiMouseButton_Left];
    const float handle = place.at(reach.share(model.weights[k]));
    const bool at_track = start.x >= place.left - 8.0f && start.x <= place.right + 8.0f && start.y >= place.text_y;
    // A click on the handle must not move it: it may be the first half of a double click.
    const bool rests = std::abs(start.x - handle) < 9.0f && !ImGui::IsMouseDragging(ImGuiMouseButton_Left, 2.0f);
    if (!at_track || rests) return;
    actions.weights.emplace_back(k, reach.weight((io.MousePos.x - place.left) / (place.right - place.left)));
}

// The field for a typed number, over the row's weight. Enter takes the number, anything else that is not one is forgotten.
void draw_number_field(const Overlay& overlay, const RowPlace& place, SliderState& state, SliderActions& actions)
{
    const float s = overlay.scale(), width = 84.0f * s;
    ImGui::SetCursorScreenPos({ place.value_right - width, place.text_y - 4.0f * s });
    ImGui::SetNextItemWidth(width);
    ImGui::PushFont(overlay.small());
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, { 6.0f * s, 3.0f * s });
    if (state.wants_focus) ImGui::SetKeyboardFocusHere();
    state.wants_focus = false;
    const ImGuiInputTextFlags flags
        = ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_CharsScientific;
    if (ImGui::InputText("##number", state.number.data(), state.number.size(), flags)) {
        const std::vector<double> values = parse_numbers(state.number.data(), ',');
        if (values.size() == 1 && are_finite(values)) actions.weights.emplace_back(*state.typed, values[0]);
    }
    if (ImGui::IsItemDeactivated()) state.typed.reset();
    ImGui::PopStyleVar();
    ImGui::PopFont();
}

void draw_head(const Overlay& overlay, const SliderModel& model, bool is_open, SliderState& state, SliderActions& actions)
{
    const float s = overlay.scale(), button = 88.0f * s;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, { 2.0f * s, 4.0f * s });
    if (ImGui::ArrowButton("open", is_open ? ImGuiDir_Down : ImGuiDir_Right)) state.open = !is_open;
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(model.of_layers ? "layers" : "weights");
    ImGui::SameLine(ImGui::GetWindowWidth() - 18.0f * s - button);
    if (ImGui::Button(model.of_layers ? "Reset all" : "All equal", { button, 0.0f })) actions.reset_all = true;
    ImGui::PopStyleVar();
    if (!is_open || model.ranges.size() <= most_without_search) return;
    ImGui::PushFont(overlay.small());
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    ImGui::InputTextWithHint("##search", "search", state.search.data(), state.search.size());
    ImGui::PopFont();
}

void draw_list(const Overlay& overlay, const SliderModel& model, SliderState& state, SliderActions& actions)
{
    const bool two_lines = on_two_lines(model);
    const float s = overlay.scale(), height = (two_lines ? high_row : low_row) * s;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, { 0.0f, 0.0f });
    ImGui::BeginChild("list", { 0.0f, 0.0f }, false, ImGuiWindowFlags_NoNav);
    const float width = ImGui::GetContentRegionAvail().x;
    bool found = false;
    for (std::uint32_t k = 0; k < model.ranges.size(); ++k) {
        if (!contains(model.ranges[k].name, state.search.data())) continue;
        found = true;
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        const RowPlace place(overlay, corner, width - 2.0f * s, two_lines);
        ImGui::PushID(static_cast<int>(k));
        ImGui::InvisibleButton("slider", { width, height });
        ImGui::SetItemAllowOverlap();
        handle_row(model, k, place, state, actions);
        draw_row(overlay, model, k, place);
        if (state.typed == k) draw_number_field(overlay, place, state, actions);
        ImGui::SetCursorScreenPos({ corner.x, corner.y + height });
        ImGui::PopID();
    }
    if (!found) ImGui::TextUnformatted("nothing has this name");
    ImGui::EndChild();
    ImGui::PopStyleVar();
}

} // namespace

SliderActions draw_sliders(const Overlay& overlay, const SliderModel& model, SliderState& state, float top, float bottom)
{
    SliderActions actions;
    const float s = overlay.scale(), row = on_two_lines(model) ? high_row : low_row;
    const float frame = head_height + 6.0f + (model.ranges.size() > most_without_search ? search_height : 0.0f);
    const float room = (bottom - top) / s - 2.0f * panel_gap;
    const float wanted = frame + row * static_cast<float>(model.ranges.size());
    const bool is_open = state.was_open = state.open.value_or(model.of_layers || wanted <= room);
    if (ImGui::GetFrameCount() > frames_to_settle && !state.open) state.open = is_open; // whatever is shown above later
    if (!is_open && room < head_height) return actions;                                 // it would cover other panels
    const float height = is_open ? std::min(wanted, std::max(room, frame + shortest_list)) : head_height;
    ImGui::SetNextWindowPos({ panel_margin * s, bottom - (height + panel_gap) * s });
    ImGui::SetNextWindowSize({ panel_width * s, height * s });
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, { 18.0f * s, 11.0f * s });
    ImGui::Begin("sliders", nullptr, panel_flags);
    ImGui::PopStyleVar();
    draw_head(overlay, model, is_open, state, actions);
    if (is_open) draw_list(overlay, model, state, actions);
    ImGui::End();
    return actions;
}

} // namespace pliant::player
