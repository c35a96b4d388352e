// Pages from made-up data, escaping, numbers, and reports read back.
#include "bake/certificate.h"
#include "output/page/certificate_facts.h"
#include "output/page/html.h"
#include "output/page/page.h"
#include "output/page/page_charts.h"
#include "output/page/report_file.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace pliant;

namespace {

const char* const hostile = "<script>alert('x')</script>\"&";

std::size_t count_of(const std::string& text, const std::string& part)
{
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

std::string check_json(const std::vector<double>& weights, double error, bool is_fresh)
{
    std::string list;
    for (const double w : weights) list += fmt::format("{}{}", list.empty() ? "" : ",", w);
    return fmt::format(R"({{"relative_l2":{},"largest_distance":0.004,"fresh":{},"converged":true,"weights":[{}]}})", error,
                       is_fresh, list);
}

std::string certificate_json(std::size_t pose_count)
{
    std::string checks;
    for (std::size_t i = 0; i < 6; ++i) {
        std::vector<double> weights(pose_count, 0.1 / double(pose_count));
        weights[i % pose_count] += 0.9;
        checks += (checks.empty() ? "" : ",") + check_json(weights, 1e-4 * double(i + 1), i == 5);
    }
    return fmt::format(R"({{"certificate":1,"baker":"pliant","tolerance":0.001,"meets_tolerance":true,
        "energy":{{"material":"<b>arap"}},"subspace":{{"dimension":4}},"stand_in":{{"kind":"cubature","elements":18}},
        "measured":{{"mean_error":3.5e-4,"largest_error":6e-4,"checks":[{}]}},
        "branches":[{{"kind":"jump","pose":"run","weights":[{}],"distance":0.1,"vertex":7}}]}})",
                       checks, fmt::join(std::vector<int>(pose_count, 1), ","));
}

PagePicture small_picture(const char* title)
{
    PagePicture picture;
    picture.image = { 2, 2, std::vector<std::uint8_t>(16, 128) };
    picture.title = title;
    picture.marks.push_back({ 1, 1, false, hostile });
    return picture;
}

PageData small_page(std::size_t pose_count)
{
    PageData data;
    data.name = std::string(hostile) + ".pliant";
    data.format = "1.3";
    data.pose_count = pose_count;
    for (std::size_t k = 0; k < pose_count; ++k) {
        data.poses.push_back(k == 0 ? hostile : fmt::format("pose {}", k));
        data.pose_pictures.push_back(small_picture(data.poses.back().c_str()));
    }
    PageBlend blend { hostile, small_picture("linear"), small_picture("elastic"), small_picture("difference"), 0.05 };
    data.centre = blend;
    data.edges = { blend };
    data.edge_count = pose_count * (pose_count - 1) / 2;
    data.vertices = 6890;
    data.file_size = 435840;
    data.dimension = 2;
    data.columns = { { 0.2, 14 }, { 0, 32 } };
    data.chunks = { { "BASC", 400000 }, { "<ab>", 12 } };
    data.certificate = certificate_json(pose_count);
    data.has_report = true;
    data.stages = { { "subspace", 12.5 }, { hostile, 1.5 } };
    PageWarning warning;
    warning.diagnostic = warning_at(4406, hostile, hostile, hostile);
    warning.picture = small_picture("marked");
    data.warnings = { warning };
    return data;
}

std::vector<std::uint32_t> many_vertices()
{
    std::vector<std::uint32_t> vertices(1000);
    for (std::uint32_t v = 0; v < vertices.size(); ++v) vertices[v] = v;
    return vertices;
}

int number_of(const std::string& report)
{
    try {
        parse_report(report, "r.json");
    } catch (const Failure& failure) {
        CHECK(failure.code() == ExitCode::bad_input);
        CHECK_FALSE(failure.diagnostics()[0].hint.empty());
        return failure.diagnostics()[0].number;
    }
    return 0;
}

} // namespace

TEST_CASE("a page of layers has ranges, the worst mixture and errors by kind, and no chart of a simplex")
{
    PageData data = small_page(4);
    data.layers = { { "smile", -0.5, 1.25, 0.25 }, { hostile, 0, 1, 0 }, { "frown", 0, 1, 0 } };
    data.poses = { "rest", "smile", hostile, "frown" };
    data.edges.clear();
    data.edge_count = 0;
    data.certificate = fmt::format(R"({{"tolerance":0.001,"meets_tolerance":true,"measured":{{"mean_error":3.5e-4,
        "largest_error":6e-4,"worst_weights":[1,0,-0.5],"checks":[{},{},{}]}},
        "branches":[{{"kind":"jump","pose":"frown","weights":[0,0,1],"distance":0.1,"vertex":7}}],
        "layers":{{"errors":[{{"kind":"pair","count":9,"without_shape":1,"mean_error":0.001,"largest_error":0.002,
        "linear_mean_error":0.03,"linear_largest_error":0.04}},{{"kind":"<b>","count":"x"}},7]}}}})",
                                   check_json({ 1, 0, -0.5 }, 6e-4, true), check_json({ 0.5, 0.5 }, 9e-4, true),
                                   check_json({ 1e9, 0, 0 }, 9e-4, true));
    const CertificateFacts facts = read_certificate_facts(data.certificate, 4, true);
    CHECK(facts.checks.size() == 1); // of as many weights as layers, none of them absurd
    CHECK(facts.worst_weights == std::vector<double> { 1, 0, -0.5 });
    REQUIRE(facts.mixtures.size() == 2);
    CHECK(facts.mixtures[1].count == 0);
    REQUIRE(facts.places.size() == 1);
    CHECK(facts.places[0].what.find("The sum of layers jumps on the path towards layer frown") == 0);
    CHECK(weights_in_words({ 1, 0, -0.5 }, data.poses) == "smile 1, frown −0.5");
    CHECK(weights_in_words({ 0, 0, 0 }, data.poses) == "no layer");
    const std::string page = write_page(data);
    CHECK(page.find("<td>smile</td><td class=\"number\">-0.5</td><td class=\"number\">1.25</td>") != std::string::npos);
    CHECK(page.find("<td>pair</td><td class=\"number\">9</td><td class=\"number\">0.10 %</td>") != std::string::npos);
    CHECK(page.find("smile 1, frown −0.5") != std::string::npos);
    CHECK(page.find("unreduced elastic sum of the layers") != std::string::npos);
    for (const char* part : { "class=\"curve\"", "class=\"blob", "check-row\"", "equal weights", "<script" })
        CHECK(page.find(part) == std::string::npos);
    CHECK(write_page(data) == page);
}

TEST_CASE("text of strangers stays text")
{
    CHECK(escape_html("a<b>&\"'c") == "a&lt;b&gt;&amp;&quot;&#39;c");
    CHECK(escape_html("Grüße, 走る, 🙂\n") == "Grüße, 走る, 🙂\n");
    CHECK(shortened("Grüße") == "Grüße");
    CHECK(shortened(std::string(199, 'a') + "ü" + std::string(1000000, 'b')) == std::string(199, 'a') + "…");
    CHECK(escape_html(std::string("a\0b\x1b", 4))
          == "a\xEF\xBF\xBD"
             "b\xEF\xBF\xBD");
    // Cut off, too long for its value, half of a pair, beyond Unicode, a byte that begins nothing.
    for (const char* bad : { "\xC3", "\xC0\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xFF", "\xE2\x82" })
        CHECK(count_of(escape_html(bad), "\xEF\xBF\xBD") == std::string(bad).size());
}

TEST_CASE("numbers with their units")
{
    CHECK(percent_text(0.00051) == "0.051 %");
    CHECK(percent_text(0.25) == "25 %");
    CHECK(percent_text(1) == "100 %");
    CHECK(percent_text(0) == "0 %");
    CHECK(percent_text(1e-9) == "1.0e-07 %");
    CHECK(percent_text(std::numeric_limits<double>::quiet_NaN()) == "unknown");
    CHECK(count_text(0) == "0");
    CHECK(count_text(999) == "999");
    CHECK(count_text(6574528) == "6,574,528");
    CHECK(bytes_text(812) == "812 bytes");
    CHECK(bytes_text(6574528) == "6.27 MiB");
    CHECK(seconds_text(185) == "3 min 05 s");
    CHECK(seconds_text(0.4211) == "0.42 s");
    CHECK(place_text(std::numeric_limits<double>::infinity()) == "0.00");
    CHECK(place_text(1e300) == "100000.00");
}

TEST_CASE("a page holds all that it is given, needs nothing else and runs nothing")
{
    for (const std::size_t pose_count : { 2u, 3u, 5u }) {
        CAPTURE(pose_count);
        const std::string page = write_page(small_page(pose_count));
        CHECK(page.find("<script") == std::string::npos);
        CHECK(page.find("alert('x')") == std::string::npos);
        CHECK(page.find("&lt;script&gt;alert(&#39;x&#39;)") != std::string::npos);
        CHECK(page.find("http://") == std::string::npos);
        CHECK(page.find("https://") == std::string::npos);
        CHECK(page.find("default-src 'none'") != std::string::npos);
        CHECK(count_of(page, "<img ") == pose_count + 7);
        CHECK(count_of(page, "src=\"data:image/png;base64,") == pose_count + 7);
        CHECK(count_of(page, "<section") == count_of(page, "</section>"));
        CHECK(count_of(page, "<svg") == count_of(page, "</svg>"));
        CHECK(count_of(page, "<div") == count_of(page, "</div>"));
        for (const char* part : { "Tolerance met", "0.035 %", "6,890", "425.6 KiB", "P4406", "12.5 s", "cubature", "BASC",
                                  "unknown to this version", "&lt;ab&gt;", "&lt;b&gt;arap", "class=\"hidden\"" })
            CHECK_MESSAGE(page.find(part) != std::string::npos, part);
        CHECK(page == write_page(small_page(pose_count)));
    }
}

TEST_CASE("errors over the weights: a curve, a triangle, bars")
{
    const auto chart = [](std::size_t pose_count) {
        return error_chart(read_certificate_facts(certificate_json(pose_count), pose_count),
                           std::vector<std::string>(pose_count, "p"));
    };
    CHECK(chart(2).find("class=\"curve\"") != std::string::npos);
    CHECK(count_of(chart(2), "<circle") == 6);
    CHECK(count_of(chart(2), "worst\"") == 1);
    CHECK(count_of(chart(3), "<circle") == 6);
    CHECK(count_of(chart(3), "fresh-blob") == 1);
    CHECK(count_of(chart(4), "class=\"check-row\"") == 6);
    CHECK(count_of(chart(4), "is-fresh") == 1);
    CHECK(weights_in_words({ 0.004, 0.596, 0.4 }, { "a", "b", "c" }) == "60 % b, 40 % c");
}

TEST_CASE("a certificate of a stranger is read as far as it makes sense")
{
    CHECK_FALSE(read_certificate_facts("nonsense", 2).is_readable);
    CHECK_FALSE(read_certificate_facts("[1]", 2).is_readable);
    std::string keys = "{", lists = "{\"a\":[[]";
    for (int i = 0; i < 1000000; ++i) keys += "\"\":0,", lists += ",[]"; // no more than that many bytes may take
    CHECK_FALSE(read_certificate_facts(keys + "\"a\":0}", 2).is_readable);
    CHECK(read_certificate_facts(lists + "]}", 2).is_readable);
    CHECK_FALSE(
        read_certificate_facts("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}", 2).is_readable);
    CHECK(read_certificate_facts(R"({"a":"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[\"[:"})", 2).is_readable);
    std::string zeros = "0";
    for (int i = 0; i < 100000; ++i) zeros += ",0";
    const std::string deep = "{\"a\":" + std::string(28, '[') + zeros + std::string(28, ']') + "}";
    CHECK(read_certificate_facts(deep, 2).pretty.size() < deep.size() + 10); // indented it is 30 times as long
    CHECK_FALSE(read_certificate_facts(std::string(100000, '['), 2).is_readable);
    const CertificateFacts odd = read_certificate_facts(
        R"({"tolerance":"x","meets_tolerance":3,"energy":[],"surrogate":null,"branches":[1,{"weights":[1,1],"vertex":-1}],
            "measured":{"checks":[{"relative_l2":1e-3,"weights":[1]},{"relative_l2":-1,"weights":[1,1]},
                                  {"relative_l2":1e-3,"weights":[0,0]},{"relative_l2":1e-3,"weights":["a",1]},7,
                                  {"relative_l2":2e-3,"weights":[1,3]}]}})",
        2);
    CHECK(odd.is_readable);
    CHECK(odd.tolerance == 0);
    CHECK_FALSE(odd.meets_tolerance.has_value());
    REQUIRE(odd.checks.size() == 1);
    CHECK(odd.checks[0].weights[1] == 0.75);
    CHECK(odd.places.empty());
    const CertificateFacts good = read_certificate_facts(certificate_json(2), 2);
    REQUIRE(good.places.size() == 1);
    CHECK(good.places[0].vertex == 7);
    PageData page = small_page(2);
    for (const char* text : { "", "{}", "3", R"({"measured":{"checks":[{"relative_l2":0,"weights":[1,1]}]}})" }) {
        page.certificate = text;
        CHECK(write_page(page).find("</html>") != std::string::npos);
    }
    page.columns = { { 0, 0 } };
    page.chunks.clear();
    page.stages.clear();
    CHECK(write_page(page).find("nan") == std::string::npos);
}

TEST_CASE("the report of a bake names its asset and its warnings and is read back")
{
    BakeReport bake;
    bake.certificate = certificate_json(2);
    bake.stages = { { "load", 0.5 }, { "check", 2 } };
    const Diagnostic turned = about_faces(warning_at(2204, "a.obj:7", "faces 3 and 4", "turn them"), { 3, 4 });
    const Diagnostic lone = about_vertices(warning_at(2207, "a.obj", "lone", ""), many_vertices());
    CHECK(lone.vertices.size() == Diagnostic::element_limit);
    CHECK(about_faces(turned, { 4, 5 }).faces == std::vector<std::uint32_t> { 3, 4, 5 }); // each once
    const std::string text = write_report(bake, "../hero.pliant", { turned, lone });
    const ReportFile report = parse_report(text, "r.json");
    CHECK(report.asset == "../hero.pliant");
    REQUIRE(report.stages.size() == 2);
    CHECK(report.stages[1].name == "check");
    CHECK(report.stages[1].seconds == 2);
    REQUIRE(report.warnings.size() == 2);
    CHECK(report.warnings[0].number == 2204);
    CHECK(report.warnings[0].where == "a.obj:7");
    CHECK(report.warnings[0].faces == std::vector<std::uint32_t> { 3, 4 });
    CHECK(report.warnings[1].vertices.size() == Diagnostic::element_limit);
    CHECK_NOTHROW(check_same_bake(text, bake.certificate, "r.json", "hero.pliant"));
    // A name that is not UTF-8 does not stop the report.
    CHECK(parse_report(write_report(bake, "h\xFFro.pliant", {}), "r.json").asset == "h\xEF\xBF\xBDro.pliant");
}

TEST_CASE("a report that is none is refused by number: P5301 to P5304")
{
    CHECK(number_of("") == 5301);
    CHECK(number_of("{\"seconds\":") == 5301);
    CHECK(number_of("[]") == 5301);
    CHECK(number_of(std::string(200000, '[')) == 5301);
    CHECK(number_of(R"({"seconds":{}})") == 5303);
    CHECK(number_of(R"({"asset":"a","seconds":{}})") == 0);
    CHECK(number_of(R"({"asset":"a","seconds":{},"warnings":[]})") == 0);
    for (const char* wrong :
         { R"({"asset":7,"seconds":{}})", R"({"asset":"","seconds":{}})", R"({"asset":"a\u0000b","seconds":{}})",
           R"({"asset":"a"})", R"({"asset":"a","seconds":[1]})", R"({"asset":"a","seconds":{"x":"1"}})",
           R"({"asset":"a","seconds":{"x":-1}})", R"({"asset":"a","seconds":{"x":null}})",
           R"({"asset":"a","seconds":{},"warnings":{}})", R"({"asset":"a","seconds":{},"warnings":[1]})",
           R"({"asset":"a","seconds":{},"warnings":[{}]})",
           R"({"asset":"a","seconds":{},"warnings":[{"number":99999,"where":"","what":"","hint":"",)"
           R"("vertices":[],"faces":[]}]})",
           R"({"asset":"a","seconds":{},"warnings":[{"number":1,"where":"","what":1,"hint":"","vertices":[],"faces":[]}]})",
           R"({"asset":"a","seconds":{},"warnings":[{"number":1,"where":"","what":"","hint":"",)"
           R"("vertices":[-1],"faces":[]}]})",
           R"({"asset":"a","seconds":{},"warnings":[{"number":1,"where":"","what":"","hint":"",)"
           R"("vertices":[],"faces":[4294967296]}]})" }) {
        CAPTURE(wrong);
        CHECK(number_of(wrong) == 5302);
    }
    try {
        check_same_bake(R"({"asset":"a","tolerance":2})", R"({"tolerance":1})", "r.json", "a");
        FAIL("another bake passes");
    } catch (const Failure& failure) {
        CHECK(failure.diagnostics()[0].number == 5304);
    }
    CHECK(looks_like_json("\xEF\xBB\xBF \n{"));
    CHECK_FALSE(looks_like_json(""));
    CHECK_FALSE(looks_like_json("PLIANT"));
}
