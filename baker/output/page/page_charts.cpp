#include "output/page/page_charts.h"

#include "output/page/html.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace pliant {

namespace {

constexpr std::size_t colour_count = 8;
constexpr std::size_t bar_limit = 60; // checks drawn, the worst

// Of drawings, in their own units; text is 12 high.
constexpr double chart_width = 460, chart_height = 250, left_margin = 58, right_margin = 14, top_margin = 14,
                 bottom_margin = 40;

std::string line(double x1, double y1, double x2, double y2, const char* kind)
{
    return fmt::format("<line class=\"{}\" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"/>", kind, place_text(x1), place_text(y1),
                       place_text(x2), place_text(y2));
}

// anchor: start, middle or end.
std::string label(double x, double y, const char* anchor, const std::string& text)
{
    return fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>", place_text(x), place_text(y), anchor,
                       escape_html(text));
}

std::string open_svg(double width, double height, const std::string& description)
{
    return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", place_text(width), place_text(height),
                       escape_html(description));
}

std::vector<std::size_t> worst_first(const std::vector<CheckFact>& checks)
{
    std::vector<std::size_t> order(checks.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return checks[a].error > checks[b].error; });
    return order;
}

std::string check_title(const CheckFact& check, const std::vector<std::string>& poses)
{
    return escape_html(fmt::format("{}: {}{}{}", percent_text(check.error), weights_in_words(check.weights, poses),
                                   check.is_fresh ? ", fresh" : "", check.has_converged ? "" : ", reference not converged"));
}

std::string point(double x, double y, const CheckFact& check, bool is_worst, const std::vector<std::string>& poses)
{
    return fmt::format("<circle class=\"{}{}\" cx=\"{}\" cy=\"{}\" r=\"{}\"><title>{}</title></circle>",
                       check.is_fresh ? "fresh" : "check", is_worst ? " worst" : "", place_text(x), place_text(y),
                       is_worst ? "5.5" : "4", check_title(check, poses));
}

// The next of 1, 2, 5, 10, ... above x, for the end of an axis.
double round_up(double x)
{
    const double decade = std::pow(10, std::floor(std::log10(x)));
    for (const double step : { 1.0, 1.5, 2.0, 3.0, 5.0, 7.5 })
        if (x <= step * decade * (1 + 1e-12)) return step * decade;
    return 10 * decade;
}

std::string error_curve(const CertificateFacts& facts, const std::vector<std::string>& poses)
{
    const std::vector<CheckFact>& checks = facts.checks;
    const std::vector<std::size_t> order = worst_first(checks);
    const double worst = checks[order[0]].error;
    // The tolerance is drawn where it does not press the curve flat.
    const bool has_tolerance = facts.tolerance > 0 && facts.tolerance < 20 * worst;
    const double highest = round_up(std::max({ worst, has_tolerance ? facts.tolerance : 0.0, 1e-12 }));
    const auto x = [&](double w) { return left_margin + w * (chart_width - left_margin - right_margin); };
    const auto y
        = [&](double e) { return chart_height - bottom_margin - e / highest * (chart_height - top_margin - bottom_margin); };
    std::string svg = open_svg(chart_width, chart_height, "Error of blends over the weight of the second pose");
    for (int i = 0; i <= 4; ++i) {
        svg += line(left_margin, y(highest * i / 4), chart_width - right_margin, y(highest * i / 4),
                    i == 0 ? "axis" : "grid");
        svg += label(left_margin - 6, y(highest * i / 4) + 4, "end", percent_text(highest * i / 4));
    }
    for (const double w : { 0.0, 0.5, 1.0 })
        svg += label(x(w), chart_height - bottom_margin + 16,
                     w == 0       ? "start"
                         : w == 1 ? "end"
                                  : "middle",
                     w == 0       ? "pose 1"
                         : w == 1 ? "pose 2"
                                  : "half and half");
    std::vector<const CheckFact*> sorted;
    for (const CheckFact& check : checks) sorted.push_back(&check);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const CheckFact* a, const CheckFact* b) { return a->weights[1] < b->weights[1]; });
    std::string path;
    for (const CheckFact* check : sorted)
        path += fmt::format("{} {},{}", path.empty() ? "M" : " L", place_text(x(check->weights[1])),
                            place_text(y(check->error)));
    svg += fmt::format("<path class=\"curve\" d=\"{}\"/>", path);
    if (has_tolerance) {
        svg += line(left_margin, y(facts.tolerance), chart_width - right_margin, y(facts.tolerance), "limit");
        svg += label(chart_width - right_margin, y(facts.tolerance) - 5, "end", "tolerance (for the mean)");
    }
    for (const CheckFact* check : sorted)
        svg += point(x(check->weights[1]), y(check->error), *check, check == &checks[order[0]], poses);
    return svg + "</svg>";
}

std::string error_triangle(const CertificateFacts& facts, const std::vector<std::string>& poses)
{
    constexpr double width = 460, height = 380, side = 360;
    const double corners[3][2] = { { width / 2 - side / 2, height - 34 },
                                   { width / 2 + side / 2, height - 34 },
                                   { width / 2, height - 34 - side * 0.8660254 } };
    std::string svg = open_svg(width, height, "Error of blends over the triangle of weights");
    for (int k = 0; k < 3; ++k) {
        const auto &a = corners[k], &b = corners[(k + 1) % 3];
        svg += line(a[0], a[1], b[0], b[1], "axis");
        const std::string number = fmt::format("pose {}", k + 1);
        svg += k == 2 ? label(a[0] + 12, a[1] + 6, "start", number) : label(a[0], a[1] + 20, "middle", number);
    }
    const std::vector<std::size_t> order = worst_first(facts.checks);
    const double worst = facts.checks[order[0]].error;
    for (auto i = order.rbegin(); i != order.rend(); ++i) { // the worst on top
        const CheckFact& check = facts.checks[*i];
        double x = 0, y = 0;
        for (std::size_t k = 0; k < 3; ++k) x += check.weights[k] * corners[k][0], y += check.weights[k] * corners[k][1];
        const double part = worst > 0 ? check.error / worst : 0;
        svg += fmt::format(
            "<circle class=\"blob{}{}\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill-opacity=\"{:.2f}\"><title>{}</title></circle>",
            check.is_fresh ? " fresh-blob" : "", *i == order[0] ? " worst" : "", place_text(x), place_text(y),
            place_text(3 + 9 * std::sqrt(part)), 0.25 + 0.6 * part, check_title(check, poses));
    }
    return svg + "</svg>";
}

std::string strip(const std::vector<double>& weights, const std::vector<std::string>& poses)
{
    std::string html = fmt::format("<span class=\"strip\" role=\"img\" aria-label=\"{}\">",
                                   escape_html(weights_in_words(weights, poses)));
    for (std::size_t k = 0; k < weights.size(); ++k)
        if (weights[k] >= 0.005)
            html += fmt::format("<i style=\"width:{:.1f}%;background:{}\"></i>", 100 * weights[k], pose_colour(k));
    return html + "</span>";
}

std::string error_bars(const CertificateFacts& facts, const std::vector<std::string>& poses)
{
    const std::vector<std::size_t> order = worst_first(facts.checks);
    const double scale = std::max({ facts.checks[order[0]].error, facts.tolerance, 1e-300 });
    std::string html = "<ul class=\"legend\">";
    for (std::size_t k = 0; k < poses.size(); ++k)
        html += fmt::format("<li><i style=\"background:{}\"></i>{}</li>", pose_colour(k), escape_html(poses[k]));
    html += "</ul><div class=\"checks\"><div class=\"check-row "
            "head\"><span>weights</span><span>error</span><span></span></div>";
    for (std::size_t i = 0; i < std::min(order.size(), bar_limit); ++i) {
        const CheckFact& check = facts.checks[order[i]];
        html += fmt::format(
            "<div class=\"check-row\" title=\"{}\">{}<span class=\"bar\"><i class=\"{}\" style=\"width:{:.2f}%\">"
            "</i>{}</span><span class=\"number\">{}</span></div>",
            check_title(check, poses), strip(check.weights, poses), check.is_fresh ? "is-fresh" : "is-check",
            100 * check.error / scale,
            facts.tolerance > 0 ? fmt::format("<b style=\"left:{:.2f}%\"></b>", 100 * facts.tolerance / scale)
                                : std::string(),
            escape_html(percent_text(check.error)));
    }
    html += "</div>";
    if (order.size() > bar_limit)
        html += fmt::format("<p class=\"note\">The {} worst of {} weights.</p>", bar_limit, order.size());
    return html;
}

} // namespace

std::string pose_colour(std::size_t pose) { return fmt::format("var(--pose-{})", pose % colour_count); }

namespace {

bool is_of_layers(const std::vector<double>& weights, const std::vector<std::string>& poses)
{
    return weights.size() + 1 == poses.size();
}

std::string layers_in_words(const std::vector<double>& weights, const std::vector<std::string>& poses)
{
    std::string text;
    for (std::size_t k = 0; k < weights.size(); ++k)
        if (std::abs(weights[k]) >= 0.005)
            text += fmt::format("{}{} {}{:.2g}", text.empty() ? "" : ", ", poses[k + 1], weights[k] < 0 ? "−" : "",
                                std::abs(weights[k]));
    return text.empty() ? "no layer" : text;
}

} // namespace

std::string weights_in_words(const std::vector<double>& weights, const std::vector<std::string>& poses)
{
    if (is_of_layers(weights, poses)) return layers_in_words(weights, poses);
    std::vector<std::size_t> order(weights.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });
    std::string text;
    for (const std::size_t k : order)
        if (weights[k] >= 0.01)
            text += fmt::format("{}{:.0f} % {}", text.empty() ? "" : ", ", 100 * weights[k],
                                k < poses.size() ? poses[k] : "?");
    return text;
}

namespace {

std::string simplex_chart(const CertificateFacts& facts, const std::vector<std::string>& poses)
{
    if (poses.size() == 2) return "<figure class=\"chart\">" + error_curve(facts, poses) + "</figure>";
    if (poses.size() == 3) return "<figure class=\"chart\">" + error_triangle(facts, poses) + "</figure>";
    return error_bars(facts, poses);
}

} // namespace

std::string error_chart(const CertificateFacts& facts, const std::vector<std::string>& poses)
{
    if (facts.checks.empty()) return {};
    std::string html = is_of_layers(facts.checks[0].weights, poses) ? "" : simplex_chart(facts, poses);
    html += "<table class=\"worst-table\"><caption>The worst weights</caption><thead><tr><th>weights</th><th "
            "class=\"number\">error</th><th class=\"number\">farthest vertex</th></tr></thead><tbody>";
    const std::vector<std::size_t> order = worst_first(facts.checks);
    for (std::size_t i = 0; i < std::min<std::size_t>(3, order.size()); ++i) {
        const CheckFact& check = facts.checks[order[i]];
        html += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>",
                            escape_html(weights_in_words(check.weights, poses)), percent_text(check.error),
                            percent_text(check.distance));
    }
    return html + "</tbody></table>";
}

std::string spectrum_chart(const std::vector<PageColumn>& columns)
{
    constexpr double height = 190, bits_top = 206, bits_height = 70, full = bits_top + bits_height + 34;
    double largest = 0, smallest = 1e300, most_bits = 8;
    for (const PageColumn& column : columns) {
        if (std::isfinite(column.amplitude)) largest = std::max(largest, column.amplitude);
        if (column.amplitude > 0) smallest = std::min(smallest, column.amplitude);
        most_bits = std::max(most_bits, std::ceil(column.bits / 8) * 8);
    }
    if (!(largest > 0)) return {};
    // Ten decades are more than single precision has.
    const double high = std::ceil(std::log10(largest) + 1e-9), low = std::max(std::floor(std::log10(smallest)), high - 10);
    const double step = (chart_width - left_margin - right_margin) / double(columns.size());
    const auto y = [&](double a) {
        return height - (std::clamp(a, low, high) - low) / std::max(high - low, 1.0) * (height - top_margin);
    };
    std::string svg = open_svg(chart_width, full, "Amplitude and bits of each column of the basis");
    for (double decade = low; decade <= high; decade += high - low > 5 ? 2 : 1) {
        svg += line(left_margin, y(decade), chart_width - right_margin, y(decade), "grid");
        svg += label(left_margin - 6, y(decade) + 4, "end", fmt::format("{:g} %", std::pow(10, decade + 2)));
    }
    const auto bits_y = [&](double bits) { return bits_top + bits_height * (1 - bits / most_bits); };
    for (const double part : { 0.0, 0.5, 1.0 }) {
        svg += line(left_margin, bits_y(part * most_bits), chart_width - right_margin, bits_y(part * most_bits),
                    part == 0 ? "axis" : "grid");
        svg += label(left_margin - 6, bits_y(part * most_bits) + 4, "end", fmt::format("{:.0f}", part * most_bits));
    }
    for (std::size_t j = 0; j < columns.size(); ++j) {
        const double x = left_margin + step * double(j) + 0.1 * step, width = 0.8 * step;
        const double bar = columns[j].amplitude > 0 ? y(std::log10(columns[j].amplitude)) : height;
        svg += fmt::format(
            "<rect class=\"amplitude\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"><title>column {}: {} of the "
            "diagonal, {:.1f} bits</title></rect>",
            place_text(x), place_text(bar), place_text(width), place_text(height - bar), j + 1,
            percent_text(columns[j].amplitude), columns[j].bits);
        svg += fmt::format("<rect class=\"bits\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>", place_text(x),
                           place_text(bits_y(columns[j].bits)), place_text(width),
                           place_text(bits_top + bits_height - bits_y(columns[j].bits)));
    }
    svg += line(left_margin, height, chart_width - right_margin, height, "axis");
    svg += label(left_margin + 4, top_margin - 2, "start", "largest motion of a vertex, relative to the diagonal");
    svg += label(left_margin + 4, bits_top - 3, "start", "bits per number");
    svg += label(left_margin, full - 16, "start", "column 1")
        + label(chart_width - right_margin, full - 16, "end", fmt::format("column {}", columns.size()));
    return "<figure class=\"chart\">" + svg + "</svg></figure>";
}

std::string bar_table(const std::vector<BarRow>& rows, const char* name_title, const char* value_title)
{
    double largest = 0;
    for (const BarRow& row : rows) largest = std::max(largest, row.part);
    std::string html = fmt::format("<table class=\"bars\"><thead><tr><th>{}</th><th></th><th class=\"number\">{}</th><th "
                                   "class=\"number\">share</th></tr></thead><tbody>",
                                   name_title, value_title);
    for (const BarRow& row : rows)
        html += fmt::format(
            "<tr><td><span class=\"name\">{}</span><span class=\"what\">{}</span></td><td class=\"bar-cell\"><span "
            "class=\"bar\"><i class=\"is-check\" style=\"width:{:.2f}%\"></i></span></td><td class=\"number\">{}</td>"
            "<td class=\"number\">{}</td></tr>",
            escape_html(row.name), escape_html(row.explanation), largest > 0 ? 100 * row.part / largest : 0.0,
            escape_html(row.value),
            row.part > 0 && row.part < 5e-4 ? "&lt; 0.1 %" : fmt::format("{:.1f} %", 100 * row.part));
    return html + "</tbody></table>";
}

} // namespace pliant
