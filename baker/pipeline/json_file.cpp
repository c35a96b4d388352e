#include "pipeline/json_file.h"

#include "input/io/source_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace pliant {
namespace {

// Our own files need four; the parser has no recursion, but whoever walks through the result has.
constexpr int nesting_limit = 32;

[[noreturn]] void fail(int number, const std::string& where, const std::string& what, const std::string& hint)
{
    throw Failure(ExitCode::bad_input, error_at(number, where, what, hint));
}

// Looks on while the parser works: nothing nested too deep, no key twice.
class Watch {
public:
    explicit Watch(const std::string& path)
        : path_(path)
    {
    }

    bool operator()(int depth, Json::parse_event_t event, const Json& value)
    {
        if (depth >= nesting_limit)
            fail(2702, path_, fmt::format("its JSON is nested more than {} deep", nesting_limit),
                 "no configuration needs that: is it the right file?");
        if (event == Json::parse_event_t::object_start) keys_.emplace_back();
        if (event == Json::parse_event_t::object_end) keys_.pop_back();
        if (event == Json::parse_event_t::key && !keys_.back().insert(value.get<std::string>()).second)
            fail(2703, path_, fmt::format("has the key {} twice in one object", excerpt(value.get<std::string>())),
                 "leave one of the two out");
        return true;
    }

private:
    const std::string& path_;
    std::vector<std::set<std::string>> keys_; // of the objects around, the innermost last
};

std::string line_and_column(const std::string& text, std::size_t byte)
{
    const std::size_t end = std::min(byte > 0 ? byte - 1 : 0, text.size());
    const std::size_t line = std::size_t(std::count(text.begin(), text.begin() + std::ptrdiff_t(end), '\n'));
    const std::size_t start = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
    return fmt::format("line {}, column {}", line + 1, end - (start == std::string::npos ? 0 : start + 1) + 1);
}

} // namespace

Json read_json_file(const std::string& path)
{
    DiagnosticList diagnostics;
    std::optional<std::string> text = read_bytes(path, diagnostics);
    if (!text) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    Json json;
    try {
        json = Json::parse(*text, Watch(path));
    } catch (const Json::parse_error& error) {
        fail(2701, path, fmt::format("is not JSON: {} is not understood", line_and_column(*text, error.byte)),
             "look for a comma, a quotation mark or a bracket there; JSON has no comments");
    } catch (const Json::out_of_range&) {
        fail(2701, path, "holds a number beyond 1.8e308", "use a smaller number");
    }
    if (!json.is_object()) fail(2701, path, "is " + kind_of(json) + ", an object expected", "write { \"key\": value, ... }");
    return json;
}

std::string json_text(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace); }

void fail_unknown_key(const std::string& where, const std::string& key, const std::vector<std::string>& known)
{
    const std::string nearest = nearest_word(key, known);
    fail(2704, where, fmt::format("there is no key {}", excerpt(key)),
         nearest.empty() ? fmt::format("the keys are {}", fmt::join(known, ", "))
                         : fmt::format("did you mean \"{}\"?", nearest));
}

std::string kind_of(const Json& value)
{
    switch (value.type()) {
    case Json::value_t::null: return "null";
    case Json::value_t::boolean: return "a boolean";
    case Json::value_t::string: return "a string";
    case Json::value_t::array: return "a list";
    case Json::value_t::object: return "an object";
    default: return "a number";
    }
}

void fail_wrong_kind(const std::string& where, const std::string& key, const std::string& wanted, const Json& value)
{
    const auto wants = [&](const char* words) { return wanted.find(words) != std::string::npos; };
    const char* hint = "write it in quotation marks"; // a string, or the name of a file
    if (wants("true or false"))
        hint = "write true or false, without quotation marks";
    else if (wants("number"))
        hint = value.is_string()    ? "write it without quotation marks"
            : wants("whole number") ? "write digits alone, without a decimal point"
                                    : "write digits, as in 0.001";
    else if (key == "range")
        hint = "write [\"0:1.3\"], or [\"smile=0:1\", \"jaw=-0.5:1\"]";
    else if (wants("list"))
        hint = "write [\"rest.ply\", \"run.ply\"]";
    else if (wants("object"))
        hint = "write { \"key\": value, ... }";
    fail(2705, where, fmt::format("\"{}\" is {}, {} expected", key, value == "" ? "empty" : kind_of(value), wanted), hint);
}

} // namespace pliant
