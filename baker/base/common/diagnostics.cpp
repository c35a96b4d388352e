#include "base/common/diagnostics.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace pliant {
namespace {

// How many file names the line "... and N more in a, b, c" spells out.
constexpr std::size_t overflow_file_limit = 3;

// "run.obj:812" -> "run.obj"
std::string without_line(const std::string& where)
{
    const std::size_t colon = where.find_last_of(':');
    if (colon == std::string::npos || colon + 1 == where.size()) return where;
    const bool is_line = std::all_of(where.begin() + static_cast<std::ptrdiff_t>(colon) + 1, where.end(),
                                     [](unsigned char c) { return c >= '0' && c <= '9'; });
    return is_line ? where.substr(0, colon) : where;
}

void add_elements(const std::vector<std::uint32_t>& more, std::vector<std::uint32_t>& elements)
{
    for (const std::uint32_t element : more) {
        if (elements.size() >= Finding::element_limit) return;
        if (std::find(elements.begin(), elements.end(), element) == elements.end()) elements.push_back(element);
    }
}

std::string join(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::string join(const std::vector<Finding>& findings)
{
    std::string text;
    for (const Finding& finding : findings) text += (text.empty() ? "" : "\n") + to_text(finding);
    return text;
}

} // namespace

Finding error_at(int number, std::string where, std::string what, std::string hint)
{
    return { Finding::Severity::error, number, std::move(where), std::move(what), std::move(hint) };
}

Finding warning_at(int number, std::string where, std::string what, std::string hint)
{
    return { Finding::Severity::warning, number, std::move(where), std::move(what), std::move(hint) };
}

Finding about_vertices(Finding finding, const std::vector<std::uint32_t>& vertices)
{
    add_elements(vertices, finding.vertices);
    return finding;
}

Finding about_faces(Finding finding, const std::vector<std::uint32_t>& faces)
{
    add_elements(faces, finding.faces);
    return finding;
}

Failure::Failure(ExitCode code, Finding finding)
    : Failure(code, std::vector<Finding> { std::move(finding) })
{
}

Failure::Failure(ExitCode code, std::vector<Finding> findings)
    : code_(code)
    , findings_(std::move(findings))
    , text_(join(findings_))
{
}

const char* Failure::what() const noexcept { return text_.c_str(); }

std::string to_text(const Finding& finding)
{
    std::string text
        = fmt::format("{} P{:04}: ", finding.severity == Finding::Severity::error ? "error" : "warning", finding.number);
    if (!finding.where.empty()) text += finding.where + ": ";
    text += finding.what;
    if (!finding.hint.empty()) text += "\n  hint: " + finding.hint;
    return text;
}

void FindingList::add(Finding finding)
{
    if (finding.severity == Finding::Severity::error) ++error_count_;
    Overflow& overflow = numbers_[finding.number];
    if (overflow.kept < lines_per_number_) {
        ++overflow.kept;
        kept_.push_back(std::move(finding));
        return;
    }
    ++overflow.dropped;
    add_elements(finding.vertices, overflow.vertices);
    add_elements(finding.faces, overflow.faces);
    std::vector<std::string>& files = overflow.dropped_files;
    if (files.size() > overflow_file_limit) return;
    std::string file = without_line(finding.where);
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(std::move(file));
}

std::vector<Finding> FindingList::findings() const
{
    std::map<int, std::size_t> last; // index of the last kept finding of each number
    for (std::size_t i = 0; i < kept_.size(); ++i) last[kept_[i].number] = i;

    std::vector<Finding> all;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        const Finding& finding = kept_[i];
        const std::size_t last_index = last.at(finding.number);
        all.push_back(finding);
        // The same advice is given once, behind the last line of its kind.
        const std::size_t dropped = numbers_.at(finding.number).dropped;
        const bool advice_follows = i != last_index ? finding.hint == kept_[last_index].hint : dropped != 0;
        if (advice_follows) all.back().hint.clear();
        if (i != last_index || dropped == 0) continue;

        const Overflow& overflow = numbers_.at(finding.number);
        std::vector<std::string> files = overflow.dropped_files;
        if (files.size() > overflow_file_limit) files[overflow_file_limit] = "...";
        const std::string what = fmt::format("... and {} more in {}", dropped, join(files));
        all.push_back({ finding.severity, finding.number, {}, what, finding.hint, overflow.vertices, overflow.faces });
    }
    return all;
}

} // namespace pliant
