#include "output/page/collect_page_data.h"

#include "output/asset/asset_facts.h"
#include "output/page/certificate_facts.h"
#include "output/page/html.h"
#include "output/page/page_charts.h"
#include "output/page/page_pictures.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace pliant {

namespace {

// What keeps a page below 2 MB, and readable.
constexpr std::size_t pose_limit = 16, edge_limit = 8, edge_search_limit = 190, marked_limit = 8, check_search_limit = 100;
constexpr int pose_size = 320, centre_size = 440, edge_size = 340, marked_size = 340;

using Coordinates = std::vector<float>;

// All shapes that the page is about, as coordinates.
struct Blends {
    std::vector<Coordinates> poses;
    Coordinates centre_linear, centre_elastic;
    struct Edge {
        std::size_t a, b;
        Coordinates linear, elastic;
    };
    std::vector<Edge> edges;
    std::vector<Coordinates> checks;
};

Coordinates linear_blend(const std::vector<Coordinates>& poses, const std::vector<float>& weights)
{
    Coordinates q(poses[0].size(), 0);
    for (std::size_t k = 0; k < poses.size(); ++k)
        for (std::size_t j = 0; j < q.size(); ++j) q[j] += weights[k] * poses[k][j];
    return q;
}

void solve_edges(RuntimeBlender& blender, Blends& out)
{
    const std::size_t m = out.poses.size();
    for (std::size_t a = 0; a < m && m > 2; ++a)
        for (std::size_t b = a + 1; b < m && out.edges.size() < edge_search_limit; ++b) {
            std::vector<float> w(m, 0);
            w[a] = w[b] = 0.5f;
            out.edges.push_back({ a, b, linear_blend(out.poses, w), blender.solve(w, false) });
        }
}

// Of layers the mixture with the largest error; where none is known, the first layers at their full strength.
std::vector<double> centre_weights(const WeightDomain& domain, const CertificateFacts& facts)
{
    if (!domain.is_box()) return std::vector<double>(domain.size(), 1 / double(domain.size()));
    if (!facts.worst_weights.empty()) return facts.worst_weights;
    std::vector<double> first(domain.size(), 0);
    for (std::size_t k = 0; k < std::min(domain.size(), sparse_limit); ++k) first[k] = domain.full(k);
    return first;
}

Blends solve_blends(RuntimeBlender& blender, const std::vector<double>& centre, const CertificateFacts& facts)
{
    const std::size_t m = blender.asset().pose_count;
    Blends out;
    for (std::uint32_t k = 0; k < m; ++k) out.poses.push_back(blender.pose_coordinates(k));
    const Weights w = Eigen::Map<const Weights>(centre.data(), Eigen::Index(centre.size()));
    const Eigen::VectorXf shares = linear_shares(w, m).cast<float>();
    out.centre_linear = linear_blend(out.poses, { shares.data(), shares.data() + shares.size() });
    out.centre_elastic = blender.solve(std::vector<float>(centre.begin(), centre.end()), false);
    if (!blender.asset().has_layers) solve_edges(blender, out);
    for (std::size_t i = 0; i < std::min(facts.checks.size(), check_search_limit); ++i) {
        const std::vector<double>& weights = facts.checks[i].weights;
        out.checks.push_back(blender.solve(std::vector<float>(weights.begin(), weights.end()), false));
    }
    return out;
}

std::vector<Coordinates> shown(const Blends& blends)
{
    std::vector<Coordinates> all = blends.poses;
    all.push_back(blends.centre_linear);
    all.push_back(blends.centre_elastic);
    return all;
}

PageBlend draw_blend(const PagePainter& painter, std::string title, const Coordinates& linear, const Coordinates& elastic,
                     int size, bool with_difference)
{
    const DrawnShape a = painter.shape(linear), b = painter.shape(elastic);
    PageBlend blend;
    blend.title = std::move(title);
    blend.linear = { painter.draw(a, size), "Linear", {}, {} };
    blend.elastic = { painter.draw(b, size), "Elastic", {}, {} };
    if (with_difference) blend.difference = PagePicture { painter.draw_difference(b, a, size), "Where they differ", {}, {} };
    blend.distance = painter.farthest(a.positions, b.positions);
    return blend;
}

void draw_edges(const PagePainter& painter, const Blends& blends, PageData& data)
{
    std::vector<std::pair<double, const Blends::Edge*>> order;
    for (const Blends::Edge& edge : blends.edges)
        order.push_back({ painter.farthest(painter.positions(edge.linear), painter.positions(edge.elastic)), &edge });
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    data.edge_count = data.pose_count > 2 && data.layers.empty() ? data.pose_count * (data.pose_count - 1) / 2 : 0;
    for (std::size_t i = 0; i < std::min(order.size(), edge_limit); ++i) {
        const Blends::Edge& edge = *order[i].second;
        data.edges.push_back(draw_blend(painter, fmt::format("½ {} + ½ {}", data.poses[edge.a], data.poses[edge.b]),
                                        edge.linear, edge.elastic, edge_size, false));
    }
}

// How far column j moves the vertex that it moves furthest, per unit of q_j: of a basis in single precision, which does not
// say.
double measured_reach(const RuntimeBlender& blender, std::uint32_t j, const std::vector<float>& origin)
{
    const pliant_asset& asset = blender.asset();
    Coordinates q(asset.dimension, 0);
    q[j] = 1;
    std::vector<float> moved(origin.size());
    pliant_reconstruct_columns(&asset, q.data(), j + 1, 0, asset.vertex_count, moved.data(), 3 * sizeof(float));
    double largest = 0;
    for (std::size_t i = 0; i < moved.size(); i += 3)
        largest = std::max(largest,
                           std::hypot(double(moved[i]) - double(origin[i]), double(moved[i + 1]) - double(origin[i + 1]),
                                      double(moved[i + 2]) - double(origin[i + 2])));
    return largest;
}

void add_columns(const RuntimeBlender& blender, const Blends& blends, double diagonal, PageData& data)
{
    const pliant_asset& asset = blender.asset();
    std::vector<Coordinates> looked = shown(blends);
    for (const Blends::Edge& edge : blends.edges) looked.push_back(edge.elastic);
    looked.insert(looked.end(), blends.checks.begin(), blends.checks.end());
    const std::vector<float> origin = blender.positions(Coordinates(asset.dimension, 0));
    data.has_stored_amplitudes = true;
    for (std::uint32_t j = 0; j < asset.dimension; ++j) {
        pliant_column column {};
        pliant_asset_column(&asset, j, &column);
        double amplitude = double(column.reach) * double(column.limit);
        if (!std::isfinite(column.reach) || !(column.limit > 0)) {
            data.has_stored_amplitudes = false;
            float farthest = 0;
            for (const Coordinates& q : looked) farthest = std::max(farthest, std::abs(q[j]));
            amplitude = measured_reach(blender, j, origin) * double(farthest);
        }
        amplitude = diagonal > 0 ? amplitude / diagonal : 0;
        data.columns.push_back({ std::isfinite(amplitude) ? amplitude : 0, double(column.bits) });
    }
}

// Certificate and report are about the same bake: its n-th place of a number belongs to the n-th warning of that number.
void add_warnings(RuntimeBlender& blender, const PagePainter& painter, const CertificateFacts& facts,
                  const ReportFile* report, const Blends& blends, PageData& data)
{
    if (report)
        for (const Diagnostic& diagnostic : report->warnings) data.warnings.push_back({ diagnostic, {} });
    else
        for (const NamedPlace& place : facts.places)
            if (place.number == 4406) data.warnings.push_back({ warning_at(4406, "", place.what, ""), {} });
    std::map<int, std::size_t> seen;
    std::size_t picture_count = 0;
    for (PageWarning& warning : data.warnings) {
        std::size_t skip = seen[warning.diagnostic.number]++;
        const NamedPlace* place = nullptr;
        for (const NamedPlace& candidate : facts.places)
            if (candidate.number == warning.diagnostic.number && skip-- == 0) {
                place = &candidate;
                break;
            }
        std::vector<std::uint32_t> vertices = warning.diagnostic.vertices;
        if (place && place->vertex < blender.asset().vertex_count) vertices.push_back(std::uint32_t(place->vertex));
        if ((vertices.empty() && warning.diagnostic.faces.empty()) || picture_count == marked_limit) continue;
        const Coordinates q = place ? blender.solve(std::vector<float>(place->weights.begin(), place->weights.end()), false)
                                    : blends.poses[0];
        PagePicture picture = painter.draw_marked(painter.shape(q), vertices, warning.diagnostic.faces, marked_size);
        if (picture.marks.empty()) continue; // nothing of it is drawn
        picture.title = place ? weights_in_words(place->weights, data.poses) : data.poses[0];
        picture.note = picture.marks[0].label;
        if (vertices.size() + warning.diagnostic.faces.size() > 1)
            picture.note += fmt::format(" and {} more", vertices.size() + warning.diagnostic.faces.size() - 1);
        warning.picture = std::move(picture);
        ++picture_count;
    }
}

void mark_roughest(const PagePainter& painter, const Coordinates& pose, std::uint32_t vertex, PagePicture& picture)
{
    PagePicture marked = painter.draw_marked(painter.shape(pose), { vertex }, {}, pose_size);
    if (marked.marks.empty()) return; // not drawn
    marked.title = picture.title;
    marked.note = "circle: the roughest vertex";
    picture = std::move(marked);
}

std::string view_text(const ViewOptions& view)
{
    const char* const kind = view.view == View::front ? "front view"
        : view.view == View::side                     ? "side view"
                                                      : "three-quarter view";
    return fmt::format("{}, {} upwards", kind, view.up == UpAxis::x ? "x" : view.up == UpAxis::y ? "y" : "z");
}

void add_facts(const RuntimeBlender& blender, PageData& data)
{
    const pliant_asset& asset = blender.asset();
    const pliant_solver_desc desc = pliant_solver_desc_default();
    data.format = format_version(asset);
    data.pose_count = asset.pose_count;
    for (std::uint32_t k = 0; k < asset.pose_count; ++k) data.poses.push_back(shortened(blender.pose_name(k)));
    const std::vector<WeightRange> ranges = blender.domain().ranges();
    for (std::size_t k = 0; k < ranges.size(); ++k)
        data.layers.push_back({ data.poses[k + 1], ranges[k].low, ranges[k].high, ranges[k].initial });
    data.vertices = asset.vertex_count;
    data.triangles = asset.triangle_count;
    data.dimension = asset.dimension;
    data.file_size = asset.blob_size;
    data.frame_bytes = frame_size(asset);
    data.solver_memory = pliant_solver_memory(&asset, &desc);
    data.is_compact = asset.columns != nullptr;
    data.bytes_per_number = double(basis_size(asset))
        / (3.0 * std::max(1.0, double(asset.vertex_count)) * std::max(1.0, double(asset.dimension)));
    for (const ChunkFact& chunk : asset_chunks(asset)) data.chunks.push_back({ chunk.tag, chunk.size });
    data.certificate = blender.certificate();
}

} // namespace

PageData collect_page_data(RuntimeBlender& blender, const std::string& name, const ReportFile* report,
                           const ViewOptions& view)
{
    PageData data;
    data.name = name;
    data.view = view_text(view);
    add_facts(blender, data);
    const CertificateFacts facts = read_certificate_facts(data.certificate, data.pose_count, !data.layers.empty());
    const std::vector<double> centre = centre_weights(blender.domain(), facts);
    const Blends blends = solve_blends(blender, centre, facts);
    const PagePainter painter(blender, shown(blends), view);
    for (std::size_t k = 0; k < std::min(data.pose_count, pose_limit + !data.layers.empty()); ++k)
        data.pose_pictures.push_back({ painter.draw(painter.shape(blends.poses[k]), pose_size), data.poses[k], {}, {} });
    if (facts.roughest_vertex && *facts.roughest_vertex < blender.asset().vertex_count)
        mark_roughest(painter, blends.poses[0], std::uint32_t(*facts.roughest_vertex), data.pose_pictures[0]);
    const std::string title = data.layers.empty() ? "All poses with equal weights" : weights_in_words(centre, data.poses);
    data.centre = draw_blend(painter, title, blends.centre_linear, blends.centre_elastic, centre_size, true);
    draw_edges(painter, blends, data);
    add_columns(blender, blends, painter.diagonal(), data);
    data.has_report = report != nullptr;
    if (report) data.stages = report->stages;
    add_warnings(blender, painter, facts, report, blends, data);
    return data;
}

} // namespace pliant
