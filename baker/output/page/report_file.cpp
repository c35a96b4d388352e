#include "output/page/report_file.h"

#include "base/common/foreign_json.h"

#include <cmath>
#include <fmt/format.h>

namespace pliant {

namespace {

using Json = nlohmann::ordered_json;

// Of a report by a stranger: more than a page can show.
constexpr std::size_t stage_limit = 100, warning_limit = 200;

// Looks into JSON and says by its path what is not as it must be.
class Reader {
public:
    explicit Reader(const std::string& path)
        : path_(path)
    {
    }

    [[noreturn]] void refuse(const std::string& member, const char* wanted) const
    {
        throw Failure(ExitCode::bad_input,
                      error_at(5302, path_, fmt::format("its member {} is not {}", member, wanted),
                               "`pliant bake --report` writes reports: bake again with this version"));
    }

    const Json& member(const Json& json, const char* name, const std::string& within, Json::value_t type,
                       const char* wanted) const
    {
        if (!json.contains(name) || json.at(name).type() != type) refuse(within + name, wanted);
        return json.at(name);
    }

    std::string text(const Json& json, const char* name, const std::string& within) const
    {
        return member(json, name, within, Json::value_t::string, "a string").get<std::string>();
    }

    std::vector<std::uint32_t> numbers(const Json& json, const char* name, const std::string& within) const
    {
        std::vector<std::uint32_t> out;
        for (const Json& value : member(json, name, within, Json::value_t::array, "a list of numbers")) {
            if (!value.is_number_unsigned() || value.get<std::uint64_t>() > 0xFFFFFFFFu)
                refuse(within + name, "a list of numbers of vertices or faces");
            if (out.size() < Diagnostic::element_limit) out.push_back(value.get<std::uint32_t>());
        }
        return out;
    }

private:
    const std::string& path_;
};

std::vector<PageStage> stages_of(const Json& json, const Reader& reader)
{
    std::vector<PageStage> stages;
    const Json& seconds = reader.member(json, "seconds", "", Json::value_t::object, "an object with a number a stage");
    for (const auto& [name, value] : seconds.items()) {
        const double number = value.is_number() ? value.get<double>() : -1;
        if (!(number >= 0) || !std::isfinite(number)) reader.refuse("seconds/" + name, "a number of seconds");
        if (stages.size() < stage_limit) stages.push_back({ name, number });
    }
    return stages;
}

// A report of an earlier version has none.
std::vector<Diagnostic> warnings_of(const Json& json, const Reader& reader)
{
    std::vector<Diagnostic> warnings;
    if (!json.contains("warnings")) return warnings;
    const Json& list = reader.member(json, "warnings", "", Json::value_t::array, "a list of warnings");
    for (std::size_t i = 0; i < std::min(list.size(), warning_limit); ++i) {
        const std::string within = fmt::format("warnings/{}/", i);
        if (!list[i].is_object()) reader.refuse(fmt::format("warnings/{}", i), "an object");
        const Json& number
            = reader.member(list[i], "number", within, Json::value_t::number_unsigned, "the number of a message");
        if (number.get<std::uint64_t>() > 9999) reader.refuse(within + "number", "the number of a message");
        Diagnostic diagnostic;
        diagnostic.severity = Diagnostic::Severity::warning;
        diagnostic.number = number.get<int>();
        diagnostic.where = reader.text(list[i], "where", within);
        diagnostic.what = reader.text(list[i], "what", within);
        diagnostic.hint = reader.text(list[i], "hint", within);
        diagnostic.vertices = reader.numbers(list[i], "vertices", within);
        diagnostic.faces = reader.numbers(list[i], "faces", within);
        warnings.push_back(std::move(diagnostic));
    }
    return warnings;
}

} // namespace

bool looks_like_json(const std::string& bytes)
{
    const std::size_t mark = bytes.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
    const std::size_t first = bytes.find_first_not_of(" \t\r\n", mark);
    return first != std::string::npos && (bytes[first] == '{' || bytes[first] == '[');
}

ReportFile parse_report(const std::string& text, const std::string& path)
{
    const Json json = parse_foreign_json(text);
    if (!json.is_object())
        throw Failure(ExitCode::bad_input,
                      error_at(5301, path, "is neither an asset nor the report of a bake",
                               "give a file that `pliant bake` wrote with -o or --report"));
    const Reader reader(path);
    ReportFile report;
    if (!json.contains("asset"))
        throw Failure(ExitCode::bad_input,
                      error_at(5303, path, "is not a report of `pliant bake --report`: it does not name its asset",
                               "bake again with --report, or give the asset itself: `pliant report hero.pliant`"));
    report.asset = reader.text(json, "asset", "");
    if (report.asset.empty() || report.asset.find('\0') != std::string::npos) reader.refuse("asset", "the name of a file");
    report.stages = stages_of(json, reader);
    report.warnings = warnings_of(json, reader);
    return report;
}

void check_same_bake(const std::string& report, const std::string& certificate, const std::string& path,
                     const std::string& asset)
{
    const Json outer = parse_foreign_json(report), inner = parse_foreign_json(certificate);
    bool is_same = outer.is_object() && inner.is_object();
    if (is_same)
        for (const auto& [key, value] : inner.items()) is_same = is_same && outer.contains(key) && outer.at(key) == value;
    if (!is_same)
        throw Failure(ExitCode::bad_input,
                      error_at(5304, path, fmt::format("belongs to another bake than {}", asset),
                               "bake again with --report, or give the asset itself: `pliant report hero.pliant`"));
}

} // namespace pliant
