#include "run/sheet.h"

#include "blend/layer_walk.h"
#include "draw/gl_context.h"
#include "draw/image_writer.h"
#include "panels/overlay.h"
#include "panels/polygon_view.h"
#include "run/stage.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::player {
namespace {

constexpr int default_cell_width = 400;
constexpr std::uint32_t max_edges = 5, max_poses = 8;

struct Blend {
    std::vector<double> weights;
    std::string caption;
};

// Mixtures of layers; the caption has a line for each that takes part.
std::vector<Blend> chosen_mixtures(const AssetFile& file)
{
    std::vector<Blend> blends;
    for (const std::vector<double>& weights : layer_mixtures(file.weights())) {
        if (blends.size() > max_edges) break;
        Blend blend { weights, "" };
        for (std::size_t k = 0; k < weights.size(); ++k) {
            if (weights[k] == file.weights()[k].initial) continue;
            char weight[32];
            std::snprintf(weight, sizeof weight, "%.2f ", weights[k]);
            blend.caption += (blend.caption.empty() ? "" : "\n") + (weight + file.weights()[k].name);
        }
        blends.push_back(blend);
    }
    return blends;
}

// Blends at the midpoints of the polygon's edges, then at its centre.
std::vector<Blend> chosen_blends(const AssetFile& file)
{
    if (file.has_layers()) return chosen_mixtures(file);
    const std::uint32_t count = file.view().pose_count;
    const std::vector<std::string>& names = file.short_names();
    std::vector<Blend> blends;
    const std::uint32_t edges = count == 2 ? 1 : std::min(count, max_edges);
    for (std::uint32_t edge = 0; edge < edges; ++edge) {
        const std::uint32_t next = (edge + 1) % count;
        Blend blend { std::vector<double>(count, 0.0), names[edge] + "\n+ " + names[next] };
        blend.weights[edge] = blend.weights[next] = 0.5;
        blends.push_back(blend);
    }
    if (count == 2) {
        for (double share : { 0.25, 0.75 })
            blends.push_back({ { 1.0 - share, share }, share < 0.5 ? "a quarter" : "three quarters" });
    } else {
        blends.push_back({ std::vector<double>(count, 1.0 / count), "all poses" });
    }
    return blends;
}

// The layout of the sheet, in pixels.
struct Layout {
    float s, margin, gap, cell_width, cell_height, caption_width, pose_width, pose_height, head;
    std::uint32_t pose_count, block_columns, block_rows;
    int width, height;

    // look: width and height of the character as seen; cells fit it unless --size is given.
    Layout(const Options& options, std::uint32_t poses, std::size_t blends, glm::vec2 look)
        : s(static_cast<float>(options.width > 0 ? options.width : default_cell_width) / default_cell_width)
        , margin(28.0f * s)
        , gap(6.0f * s)
        , cell_width(static_cast<float>(options.width > 0 ? options.width : default_cell_width))
        , cell_height(options.height > 0 ? static_cast<float>(options.height) : fitting_height(look))
        , caption_width(150.0f * s)
        , pose_count(std::min(poses, max_poses))
        , block_columns(blends > 3 ? 2 : 1)
        , block_rows(static_cast<std::uint32_t>((blends + block_columns - 1) / block_columns))
    {
        const float block = block_width();
        const float inside = block * static_cast<float>(block_columns) + margin * static_cast<float>(block_columns - 1);
        pose_width = std::floor(std::min((inside + gap) / static_cast<float>(pose_count) - gap, cell_width));
        pose_height = std::floor(pose_width * cell_height / cell_width);
        head = margin + 66.0f * s + pose_height + 56.0f * s;
        width = static_cast<int>(inside + 2.0f * margin);
        height = static_cast<int>(head + (cell_height + gap) * static_cast<float>(block_rows) + margin);
    }

    // With room for the caption above and the shadow below; the aspect ratio is bounded.
    float fitting_height(glm::vec2 look) const
    {
        return std::floor(cell_width * std::clamp(0.18f + 1.08f * look.y / std::max(look.x, 1e-6f), 0.55f, 1.25f));
    }
    float block_width() const { return caption_width + 2.0f * cell_width + gap; }
    Area pose(std::uint32_t k) const
    {
        return { std::floor(margin + (pose_width + gap) * static_cast<float>(k)), std::floor(margin + 66.0f * s), pose_width,
                 pose_height };
    }
    // column: 0 caption, 1 linear, 2 elastic.
    Area cell(std::size_t blend, int column) const
    {
        const auto block_column = static_cast<float>(blend / block_rows), row = static_cast<float>(blend % block_rows);
        const float x = margin + block_column * (block_width() + margin) + (column > 0 ? caption_width : 0.0f)
            + (column == 2 ? cell_width + gap : 0.0f);
        return { std::floor(x), std::floor(head + row * (cell_height + gap)), column > 0 ? cell_width : caption_width,
                 cell_height };
    }
};

void clear_paper(const Canvas& canvas)
{
    canvas.begin();
    glDisable(GL_SCISSOR_TEST);
    glClearColor(1.0f, 1.0f, 1.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

// Lines of text, one below the other, centred at the height `y`.
void draw_lines(const Overlay& overlay, const Layout& layout, ImVec2 place, const std::string& text)
{
    std::size_t start = 0;
    for (std::size_t end = 0; end != std::string::npos; start = end + 1, place.y += 22.0f * layout.s) {
        end = text.find('\n', start);
        const std::string line
            = elided(overlay.text(), text.substr(start, end - start), layout.caption_width - 6.0f * layout.s);
        draw_text(ImGui::GetBackgroundDrawList(), overlay.text(), place, { 0.5f, 0.0f }, ink, line);
    }
}

// Left of a blend: where it is in the polygon, and its name. Mixtures of layers have a name only.
void draw_blend_caption(const Overlay& overlay, const Layout& layout, const AssetFile& file, const ControlPolygon& polygon,
                        const Blend& blend, const Area& area)
{
    const float s = layout.s, middle = area.x + 0.5f * area.width - 6.0f * s, high = area.y + 0.42f * area.height;
    if (file.has_layers()) {
        const auto breaks = static_cast<float>(std::count(blend.caption.begin(), blend.caption.end(), '\n'));
        draw_lines(overlay, layout, { middle, high - 11.0f * s * breaks }, blend.caption);
        return;
    }
    const PolygonView view { polygon, file.short_names(), { middle, high }, 46.0f * s, 0.0f };
    draw_polygon(ImGui::GetBackgroundDrawList(), overlay, view, blend.weights, polygon.point(blend.weights), false);
    draw_lines(overlay, layout, { middle, high + 66.0f * s }, blend.caption);
}

void draw_captions(const Overlay& overlay, const Layout& layout, const AssetFile& file, const ControlPolygon& polygon,
                   const std::vector<Blend>& blends)
{
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const float s = layout.s;
    const pliant_asset& asset = file.view();
    const std::string facts
        = file.counted() + " · " + grouped(asset.vertex_count) + " vertices · d = " + std::to_string(asset.dimension);
    const ImVec2 title = draw_text(list, overlay.title(), { layout.margin, layout.margin }, {}, ink, file.title());
    draw_text(list, overlay.text(), { layout.margin + title.x + 16.0f * s, layout.margin + 5.0f * s }, {}, faint_ink, facts);
    for (std::uint32_t k = 0; k < layout.pose_count; ++k) {
        const Area area = layout.pose(k);
        const ImVec2 dot { area.x + 16.0f * s, area.y + 18.0f * s };
        list->AddCircleFilled(dot, 5.5f * s, pose_colour(k, asset.pose_count, 1.0f), 24);
        const std::string name = elided(overlay.small(), file.short_names()[k], area.width - 34.0f * s);
        draw_text(list, overlay.small(), { dot.x + 12.0f * s, dot.y }, { 0.0f, 0.5f }, ink, name);
    }
    for (std::size_t i = 0; i < blends.size(); ++i) {
        draw_blend_caption(overlay, layout, file, polygon, blends[i], layout.cell(i, 0));
        const Area linear = layout.cell(i, 1), elastic = layout.cell(i, 2);
        draw_text(list, overlay.text(), { linear.x + 14.0f * s, linear.y + 12.0f * s }, {}, linear_ink, "linear");
        draw_text(list, overlay.text(), { elastic.x + 14.0f * s, elastic.y + 12.0f * s }, {}, elastic_ink, "elastic");
    }
}

// A shape on the sheet. Both blends of the same weights have one extent, of both shapes.
struct Tile {
    std::vector<double> weights;
    Show show;
    Extent extent;
};

// The poses, then linear and elastic of each blend.
std::vector<Tile> tiles_of(Stage& stage, const AssetFile& file, std::uint32_t poses, const std::vector<Blend>& blends)
{
    std::vector<Tile> tiles;
    for (std::uint32_t k = 0; k < poses; ++k) {
        const std::vector<double> weights = weights_of_pose(file.view(), k);
        stage.blend(weights, Show::linear);
        tiles.push_back({ weights, Show::linear, stage.extent_shown() });
    }
    for (const Blend& blend : blends) {
        stage.forget(); // each cell is a cold solve, not a step of an animation
        stage.blend(blend.weights, Show::both);
        for (Show show : { Show::linear, Show::elastic }) tiles.push_back({ blend.weights, show, stage.extent_shown() });
    }
    return tiles;
}

// Width and height of the largest tile's shapes as seen, and the distance at which all fit into a cell of the layout.
glm::vec2 largest_look(Camera& camera, const std::vector<Tile>& tiles)
{
    glm::vec2 look(0.0f);
    for (const Tile& tile : tiles) {
        camera.frame(tile.extent);
        look = glm::max(look, camera.size());
    }
    return look;
}

float distance_for_all(Camera& camera, const std::vector<Tile>& tiles, const Area& cell)
{
    float distance = 0.0f;
    for (const Tile& tile : tiles) {
        camera.frame(tile.extent);
        const Area whole { 0.0f, 0.0f, cell.width, cell.height };
        distance = std::max(distance, camera.place({ cell.width, cell.height }, whole).distance);
    }
    return distance;
}

} // namespace

void write_sheet(const Options& options, const AssetFile& file)
{
    const std::vector<Blend> blends = chosen_blends(file);
    const auto context = make_offscreen_context();
    Stage stage(options, file, nullptr, Quality::high);
    const std::uint32_t poses = std::min(file.view().pose_count, max_poses);
    const std::vector<Tile> tiles = tiles_of(stage, file, poses, blends);
    const Layout layout(options, poses, blends.size(), largest_look(stage.camera(), tiles));
    const Canvas canvas(layout.width, layout.height);
    clear_paper(canvas);
    const float distance = distance_for_all(stage.camera(), tiles, layout.cell(0, 1));
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const std::size_t of_blends = i - std::min<std::size_t>(i, poses);
        const Area area = i < poses ? layout.pose(static_cast<std::uint32_t>(i))
                                    : layout.cell(of_blends / 2, of_blends % 2 == 0 ? 1 : 2);
        if (i >= poses) stage.forget();
        stage.blend(tiles[i].weights, tiles[i].show);
        stage.camera().frame(tiles[i].extent);
        stage.draw_tile(canvas, area, distance, i < poses);
    }
    canvas.resolve();
    Overlay overlay(layout.s, nullptr);
    overlay.need_letters(file.letters());
    overlay.begin_frame(layout.width, layout.height);
    draw_captions(overlay, layout, file, stage.polygon(), blends);
    overlay.end_frame();
    write_png(options.sheet, layout.width, layout.height, canvas.pixels());
}

} // namespace pliant::player
