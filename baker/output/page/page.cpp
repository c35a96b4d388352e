#include "output/page/page.h"

#include "base/weights/domain.h"
#include "output/page/certificate_facts.h"
#include "output/page/html.h"
#include "output/page/page_charts.h"
#include "output/page/page_style.h"
#include "output/page/png.h"

#include <cmath>
#include <fmt/format.h>

namespace pliant {

namespace {

std::string section(const char* id, const char* title, const std::string& sentence, const std::string& body)
{
    return fmt::format("<section id=\"{}\"><h2>{}</h2>\n<p>{}</p>\n{}</section>\n", id, title, sentence, body);
}

std::string marks_svg(const PagePicture& picture)
{
    if (picture.marks.empty()) return {};
    std::string svg
        = fmt::format("<svg viewBox=\"0 0 {} {}\" aria-hidden=\"true\">", picture.image.width, picture.image.height);
    for (const PageMark& mark : picture.marks)
        svg += fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"11\"><title>{}</title></circle>",
                           mark.is_visible ? "seen" : "hidden", place_text(double(mark.x)), place_text(double(mark.y)),
                           escape_html(mark.label));
    return svg + "</svg>";
}

std::string figure(const PagePicture& picture, const char* kind, bool is_small = false)
{
    const std::string note
        = picture.note.empty() ? std::string() : fmt::format("<span class=\"note\">{}</span>", escape_html(picture.note));
    return fmt::format("<figure class=\"{}{}\"><div class=\"picture\"><div><img src=\"{}\" width=\"{}\" height=\"{}\" "
                       "alt=\"{}\">{}</div></div><figcaption>{}{}</figcaption></figure>\n",
                       kind, is_small ? " small" : "", data_uri(picture.image), picture.image.width, picture.image.height,
                       escape_html("Picture: " + picture.title), marks_svg(picture), escape_html(picture.title), note);
}

std::string fact(const char* name, const std::string& value)
{
    return fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", name, escape_html(value));
}

std::string verdict(const CertificateFacts& facts, std::size_t layer_count)
{
    if (!facts.is_readable)
        return "<p class=\"verdict\">The certificate in this asset cannot be read, so its measured errors are unknown.</p>";
    if (facts.checks.empty() || !facts.mean_error)
        return "<p class=\"verdict\">The bake measured no errors: it was run without check weights.</p>";
    const bool is_kept = facts.meets_tolerance.value_or(false);
    return fmt::format(
        "<p class=\"verdict\"><b class=\"{}\">Tolerance {}.</b> Blends at {} weights differ from the unreduced "
        "elastic {} by a mean of {} and at most {}; the tolerance for the mean is {}.{}</p>",
        is_kept ? "kept" : "missed", is_kept ? "met" : "missed", facts.checks.size(),
        layer_count ? "sum of the layers" : "average", percent_text(*facts.mean_error),
        percent_text(facts.largest_error.value_or(NAN)), percent_text(facts.tolerance),
        layer_count > sparse_limit ? " Mixtures of more than six layers are not counted." : "");
}

std::string header(const PageData& data, const CertificateFacts& facts)
{
    std::string html = fmt::format("<header><p class=\"kind\">Pliant asset</p><h1>{}</h1>{}<dl class=\"facts\">",
                                   escape_html(data.name), verdict(facts, data.layers.size()));
    html
        += data.layers.empty() ? fact("Poses", count_text(data.pose_count)) : fact("Layers", count_text(data.layers.size()));
    html += fact("Vertices", count_text(data.vertices));
    html += fact("Triangles", count_text(data.triangles)) + fact("Dimension d", count_text(data.dimension));
    for (const auto& [title, rows] : facts.groups)
        for (const auto& [name, value] : rows)
            if (name == "Elements" || name == "Kind") html += fact(name == "Kind" ? "Surrogate energy" : "Elements", value);
    html += fact("File size", bytes_text(double(data.file_size)));
    html += fact("Read per frame", bytes_text(double(data.frame_bytes)));
    html += fact("Solver memory per character", bytes_text(double(data.solver_memory)));
    if (facts.largest_distance) html += fact("Largest error of a vertex", percent_text(*facts.largest_distance));
    if (data.has_report) html += fact("Warnings", count_text(data.warnings.size()));
    return html + "</dl></header>\n";
}

std::string layer_table(const std::vector<PageLayer>& layers)
{
    std::string html = "<table><thead><tr><th>layer</th><th class=\"number\">lowest weight</th><th class=\"number\">"
                       "highest weight</th><th class=\"number\">start</th></tr></thead><tbody>";
    for (const PageLayer& layer : layers)
        html += fmt::format("<tr><td>{}</td><td class=\"number\">{:.3g}</td><td class=\"number\">{:.3g}</td>"
                            "<td class=\"number\">{:.3g}</td></tr>",
                            escape_html(layer.name), layer.low, layer.high, layer.initial);
    return html + "</tbody></table>";
}

std::string layers_section(const PageData& data)
{
    std::string body = "<div class=\"gallery\">";
    for (const PagePicture& picture : data.pose_pictures) body += figure(picture, "pose");
    body += "</div>" + layer_table(data.layers);
    std::string sentence
        = fmt::format("The rest shape, and each layer at the weight 1, all at one scale ({}). ", escape_html(data.view));
    if (data.pose_pictures.size() < data.pose_count)
        sentence += fmt::format("Shown are the first {} of {} layers. ", data.pose_pictures.size() - 1, data.layers.size());
    return section(
        "poses", "Layers",
        sentence + "The table has the weights at which the bake measured; others blend as well, without a promise.", body);
}

std::string poses_section(const PageData& data)
{
    if (!data.layers.empty()) return layers_section(data);
    std::string body = "<div class=\"gallery\">";
    for (const PagePicture& picture : data.pose_pictures) body += figure(picture, "pose");
    body += "</div>";
    std::string sentence = fmt::format("The poses as the asset stores them, all at one scale ({}).", escape_html(data.view));
    if (data.pose_pictures.size() < data.pose_count)
        sentence += fmt::format(" Shown are the first {} of {} poses.", data.pose_pictures.size(), data.pose_count);
    return section("poses", "Poses", sentence, body);
}

std::string blend_html(const PageBlend& blend)
{
    std::string html
        = fmt::format("<div><h3>{}</h3><div class=\"{}\">", escape_html(blend.title), blend.difference ? "trio" : "pair");
    html += figure(blend.linear, "linear") + figure(blend.elastic, "elastic");
    if (blend.difference) html += figure(*blend.difference, "coloured");
    const char* const note = blend.difference
        ? "</div><p class=\"note\">Distance between the two: 0<span class=\"scale\"></span>{} of the diagonal.</p></div>"
        : "</div><p class=\"note\">Largest distance between the two: {} of the diagonal.</p></div>";
    return html + fmt::format(fmt::runtime(note), percent_text(blend.distance));
}

std::string mixture_section(const PageData& data, const CertificateFacts& facts)
{
    const bool is_worst = !facts.worst_weights.empty();
    return section(
        "blends", is_worst ? "The worst mixture" : "A mixture of layers",
        fmt::format("{} Left: the linear sum, as morph targets give it. Right: the elastic blend that the runtime "
                    "computes.",
                    is_worst ? "The mixture whose blend is farthest from the unreduced elastic sum."
                             : "The first layers at their full strength."),
        data.centre ? blend_html(*data.centre) : "");
}

std::string blends_section(const PageData& data, const CertificateFacts& facts)
{
    if (!data.layers.empty()) return mixture_section(data, facts);
    std::string body;
    if (data.centre) body += blend_html(*data.centre);
    if (!data.edges.empty()) {
        body += "<div class=\"pairs\">";
        for (const PageBlend& edge : data.edges) body += blend_html(edge);
        body += "</div>";
    }
    if (data.edges.size() < data.edge_count)
        body += fmt::format("<p class=\"note\">The {} of {} pairs of poses in which linear and elastic differ most.</p>",
                            data.edges.size(), data.edge_count);
    return section("blends", "Blends",
                   "Left: the linear blend, a weighted mean of positions. Right: the elastic blend that the runtime "
                   "computes. Parts that rotate between poses shrink or flatten in the linear blend.",
                   body);
}

std::string mixture_row(const MixtureFact& mixture)
{
    std::string html
        = fmt::format("<tr><td>{}</td><td class=\"number\">{}</td>", escape_html(mixture.kind), count_text(mixture.count));
    for (const double error : { mixture.mean, mixture.largest, mixture.linear_mean, mixture.linear_largest })
        html += fmt::format("<td class=\"number\">{}</td>", mixture.count ? percent_text(error) : "");
    return html + fmt::format("<td class=\"number\">{}</td></tr>", count_text(mixture.lost_count));
}

// Of layers: the errors by kind of mixture beside those of the linear sum.
std::string mixtures_section(const CertificateFacts& facts, const std::vector<std::string>& poses)
{
    std::string body = "<table class=\"mixtures\"><thead><tr><th>mixture</th><th class=\"number\">weights</th>"
                       "<th class=\"number\">mean error</th><th class=\"number\">largest</th>"
                       "<th class=\"number\">linear sum, mean</th><th class=\"number\">largest</th>"
                       "<th class=\"number\">no shape</th></tr></thead><tbody>";
    for (const MixtureFact& mixture : facts.mixtures) body += mixture_row(mixture);
    return section(
        "errors", "Errors by kind of mixture",
        "The relative L2 error of a blend is the distance of its vertices from the unreduced elastic sum of the "
        "layers (root mean square over the surface, after rigid alignment), divided by their distance from the "
        "centroid. Beside it stands that of the linear sum, as morph targets give it. Sparse mixtures have three to "
        "six layers, dense ones all, corners have each layer at an end of its range. At some weights there is no "
        "elastic sum to compare with: no shape.",
        body + "</tbody></table>" + error_chart(facts, poses));
}

std::string error_section(const PageData& data, const CertificateFacts& facts)
{
    if (facts.checks.empty())
        return section("errors", "Errors over the weights", "The certificate has no checks, so the errors are unknown.", "");
    if (!data.layers.empty()) return mixtures_section(facts, data.poses);
    std::string sentence
        = "The relative L2 error of a blend is the distance of its vertices from the unreduced elastic average (root mean "
          "square over the surface, after rigid alignment), divided by their distance from the centroid.";
    if (data.pose_count == 2)
        sentence
            += " Filled points were used to choose the dimension and the elements; hollow points are fresh weights, which "
               "were not used for any choice.";
    else if (data.pose_count == 3)
        sentence += " Larger and darker circles have larger errors. Dashed circles are fresh weights, which were not used "
                    "for any choice.";
    else
        sentence
            += " One row per check, the largest error first. Hollow bars are fresh weights, which were not used for any "
               "choice. The dashed line is the tolerance for the mean.";
    if (data.pose_count <= 3) {
        sentence += " Here";
        for (std::size_t k = 0; k < data.poses.size(); ++k)
            sentence += fmt::format("{} pose {} is {}", k ? "," : "", k + 1, escape_html(data.poses[k]));
        sentence += ".";
    }
    return section("errors", "Errors over the weights", sentence, error_chart(facts, data.poses));
}

std::string warnings_section(const PageData& data)
{
    if (!data.has_report && data.warnings.empty())
        return section(
            "warnings", "Warnings",
            "The certificate has no warnings. Warnings about the pose files are in the report of the bake (pliant bake "
            "--report), not in the asset.",
            "");
    if (data.warnings.empty()) return section("warnings", "Warnings", "None.", "");
    std::string body;
    for (const PageWarning& warning : data.warnings) {
        const Diagnostic& f = warning.diagnostic;
        body += fmt::format("<div class=\"warning\"><div><p><span class=\"code\">P{:04}</span> {}{}</p>", f.number,
                            f.where.empty() ? "" : escape_html(f.where) + ": ", escape_html(f.what));
        if (!f.hint.empty()) body += fmt::format("<p class=\"note\">{}</p>", escape_html(f.hint));
        body += "</div>";
        if (warning.picture) body += figure(*warning.picture, "coloured");
        body += "</div>";
    }
    return section(
        "warnings", "Warnings",
        data.has_report
            ? "The warnings of the bake. Their faces are marked in colour, their vertices by a circle; the circle is dashed "
              "if the vertex is behind the shape."
            : "The warnings of the certificate in the asset. Their vertices are marked by a circle, dashed if the vertex is "
              "behind the shape. The report of the bake (pliant bake --report) has the other warnings.",
        body);
}

std::string spectrum_section(const PageData& data)
{
    const std::string source = data.has_stored_amplitudes ? "over the blends of the bake"
                                                          : "over the blends on this page (the asset does not store it)";
    return section("basis", "Spectrum of the basis",
                   fmt::format("A blend is the rest shape plus {} columns, each multiplied by a number. Above: the largest "
                               "motion of a vertex by each column, {}. Below: the bits per number of each column, {:.2f} "
                               "bytes on average{}.",
                               data.dimension, source, data.bytes_per_number, data.is_compact ? "" : " (single precision)"),
                   spectrum_chart(data.columns));
}

// What each chunk is for (formats/SPEC.md).
const char* chunk_purpose(const std::string& tag)
{
    static const std::pair<const char*, const char*> purposes[] = {
        { "SOLV", "start and scaling of the solver" },
        { "ELEM", "elements of the surrogate energy" },
        { "QUAR", "quartic surrogate energy" },
        { "PRED", "predictor of the solver's start" },
        { "LOAD", "dead load, corrects the surrogate energy" },
        { "REST", "rest positions" },
        { "TRIS", "triangles" },
        { "MRNG", "ranges of morph weights" },
        { "LAYR", "ranges of the layers' weights" },
        { "VERT", "vertex numbers of the pose files" },
        { "SMTH", "vertices that share a normal" },
        { "POLY", "faces of the pose files" },
        { "NAME", "names of the poses" },
        { "ANSW", "stored answers, for validation" },
        { "CERT", "certificate" },
        { "GLTF", "textures and materials" },
        { "BASI", "basis, single precision" },
        { "BASC", "basis, compact" },
        { "BASF", "rest positions and basis, factored" },
        { "BNDS", "bounding boxes" },
    };
    for (const auto& [name, purpose] : purposes)
        if (tag == name) return purpose;
    return "unknown to this version";
}

std::string bytes_section(const PageData& data)
{
    std::vector<BarRow> rows;
    std::uint64_t rest = data.file_size;
    const double whole = double(std::max<std::uint64_t>(data.file_size, 1));
    for (const PageChunk& chunk : data.chunks) {
        rows.push_back({ chunk.tag, chunk_purpose(chunk.tag), count_text(chunk.size), double(chunk.size) / whole });
        rest -= std::min(rest, chunk.size);
    }
    std::stable_sort(rows.begin(), rows.end(), [](const BarRow& a, const BarRow& b) { return a.part > b.part; });
    rows.push_back({ "rest", "header and padding", count_text(rest), double(rest) / whole });
    return section("bytes", "File size by chunk",
                   fmt::format("The file has {} bytes ({}, format {}). Each frame reads {} of them to rebuild all vertices.",
                               count_text(data.file_size), bytes_text(double(data.file_size)), escape_html(data.format),
                               bytes_text(double(data.frame_bytes))),
                   bar_table(rows, "chunk", "bytes"));
}

std::string seconds_section(const PageData& data)
{
    if (!data.has_report)
        return section("seconds", "Time by stage",
                       "An asset stores no times. Bake with --report REPORT.json and run pliant report on that file.", "");
    double sum = 0;
    for (const PageStage& stage : data.stages) sum += stage.seconds;
    std::vector<BarRow> rows;
    for (const PageStage& stage : data.stages)
        rows.push_back({ stage.name, "", seconds_text(stage.seconds), sum > 0 ? stage.seconds / sum : 0 });
    return section("seconds", "Time by stage",
                   fmt::format("The bake took {} of wall-clock time. The stages in order:", seconds_text(sum)),
                   bar_table(rows, "stage", "time"));
}

std::string certificate_section(const CertificateFacts& facts)
{
    if (!facts.is_readable) return section("certificate", "Certificate", "It is not JSON.", "");
    std::string body = "<div class=\"groups\">";
    for (const auto& [title, rows] : facts.groups) {
        if (rows.empty()) continue;
        body += fmt::format("<div><h3>{}</h3><dl>", title);
        for (const auto& [name, value] : rows) body += fmt::format("<dt>{}</dt><dd>{}</dd>", name, escape_html(value));
        body += "</dl></div>";
    }
    body += fmt::format("</div><details><summary>The certificate as JSON</summary><pre>{}</pre></details>",
                        escape_html(facts.pretty));
    return section(
        "certificate", "Certificate",
        "The asset stores how it was baked and what was measured, without times and paths: the same poses and options give "
        "the same text.",
        body);
}

} // namespace

std::string write_page(const PageData& data)
{
    const CertificateFacts facts = read_certificate_facts(data.certificate, data.pose_count, !data.layers.empty());
    // The policy forbids every request and every script, whatever strangers' texts hold.
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
        "'unsafe-inline'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{} – Pliant report</title>\n"
        "<style>{}</style></head>\n<body><main>\n",
        escape_html(data.name), page_style);
    html += header(data, facts) + poses_section(data) + blends_section(data, facts) + error_section(data, facts)
        + warnings_section(data);
    html += spectrum_section(data) + bytes_section(data) + seconds_section(data) + certificate_section(facts);
    return html
        + "<footer>Written by pliant report. “The diagonal” is the bounding-box diagonal of the first pose.</footer>\n"
          "</main></body></html>\n";
}

} // namespace pliant
