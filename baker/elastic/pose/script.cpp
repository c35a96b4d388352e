#include "elastic/pose/script.h"

#include "input/io/source_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace pliant {

namespace {

constexpr char shapes_hint[] = "a line begins with box x0 y0 z0 x1 y1 z1, sphere x y z r or vertices i j k ...";
constexpr char motions_hint[] = "after the region write hold, move dx dy dz or turn px py pz ax ay az degrees";

// Of a line, all motions together; beyond them is a typing error rather than a pose, and each degree takes time.
constexpr double degrees_limit = 3600, diagonals_limit = 10;
constexpr std::size_t motions_limit = 100;

bool is_motion(std::string_view word) { return word == "hold" || word == "move" || word == "turn"; }

// Reads one line. Whatever returns false has reported an error.
class LineParser {
public:
    LineParser(std::string_view line, std::string where, DiagnosticList& diagnostics)
        : rest_(line)
        , where_(std::move(where))
        , diagnostics_(diagnostics)
    {
        advance();
    }

    bool is_empty() const { return word_.empty(); }
    bool read_region(Region& region);
    bool read_motions(std::vector<Motion>& motions);

private:
    void advance() { word_ = next_word(rest_, '#'); }
    bool fail(int number, std::string what, std::string hint)
    {
        diagnostics_.add(error_at(number, where_, std::move(what), std::move(hint)));
        return false;
    }
    bool read_numbers(const char* name, const char* form, double* values, int count);
    bool read_box(Region& region);
    bool read_sphere(Region& region);
    bool read_vertices(Region& region);
    bool read_move(Motion& motion);
    bool read_turn(Motion& motion);
    bool check_extent(const std::vector<Motion>& motions);

    std::string_view rest_, word_;
    std::string where_;
    DiagnosticList& diagnostics_;
};

std::optional<double> parse_number(std::string_view word)
{
    if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

bool LineParser::read_numbers(const char* name, const char* form, double* values, int count)
{
    const std::string hint = fmt::format("write {} {}", name, form);
    for (int i = 0; i < count; ++i) {
        if (word_.empty() || is_motion(word_))
            return fail(2804, fmt::format("{} has {} of {} numbers", name, i, count), hint);
        const std::optional<double> value = parse_number(word_);
        if (!value) return fail(2805, fmt::format("{}: {} is not a number", name, excerpt(word_)), hint);
        values[i] = *value;
        advance();
    }
    return true;
}

bool LineParser::read_box(Region& region)
{
    double v[6];
    if (!read_numbers("box", "x0 y0 z0 x1 y1 z1", v, 6)) return false;
    region.kind = Region::Kind::box;
    region.lower = Eigen::Vector3d(v[0], v[1], v[2]);
    region.upper = Eigen::Vector3d(v[3], v[4], v[5]);
    if ((region.lower.array() > region.upper.array()).any())
        return fail(2806, "the first corner of the box lies above the second one", "give the lower corner first");
    return true;
}

bool LineParser::read_sphere(Region& region)
{
    double v[4];
    if (!read_numbers("sphere", "x y z r", v, 4)) return false;
    region.kind = Region::Kind::sphere;
    region.lower = Eigen::Vector3d(v[0], v[1], v[2]);
    region.radius = v[3];
    if (!(region.radius > 0))
        return fail(2807, fmt::format("the radius {} is not positive", v[3]),
                    "it is a fraction of the diagonal of the bounding box");
    return true;
}

bool LineParser::read_vertices(Region& region)
{
    region.kind = Region::Kind::vertices;
    for (; !word_.empty() && !is_motion(word_); advance()) {
        const std::optional<std::int64_t> vertex = parse_integer(word_);
        if (!vertex || *vertex < 0 || *vertex >= std::int64_t(vertex_count_limit))
            return fail(2808, fmt::format("{} is not a vertex number", excerpt(word_)),
                        "write vertex numbers, counted from 0 in the order of the mesh file, and then hold, move or turn");
        region.vertices.push_back(std::uint32_t(*vertex));
    }
    if (region.vertices.empty()) return fail(2808, "no vertex is named", "write vertices i j k ..., counted from 0");
    return true;
}

bool LineParser::read_region(Region& region)
{
    const std::string_view name = word_;
    advance();
    if (name == "box") return read_box(region);
    if (name == "sphere") return read_sphere(region);
    if (name == "vertices") return read_vertices(region);
    return fail(2802, fmt::format("region {} not understood", excerpt(name)), shapes_hint);
}

bool LineParser::read_move(Motion& motion)
{
    double v[3];
    if (!read_numbers("move", "dx dy dz", v, 3)) return false;
    motion.kind = Motion::Kind::move;
    motion.by = Eigen::Vector3d(v[0], v[1], v[2]);
    return true;
}

bool LineParser::read_turn(Motion& motion)
{
    double v[7];
    if (!read_numbers("turn", "px py pz ax ay az degrees", v, 7)) return false;
    motion.kind = Motion::Kind::turn;
    motion.pivot = Eigen::Vector3d(v[0], v[1], v[2]);
    motion.axis = Eigen::Vector3d(v[3], v[4], v[5]);
    motion.degrees = v[6];
    const double length = motion.axis.stableNorm();
    if (!(length > 0) || !std::isfinite(length))
        return fail(2809, "the axis has no direction", "for example 0 1 0 to turn about the y axis");
    motion.axis /= length;
    return true;
}

// How far a turn about a pivot far from the box moves what is in it, in diagonals or less (pivots are fractions of edges).
double reach_of(const Motion& turn)
{
    const double beyond = std::max(0.0, (turn.pivot.array() - 0.5).abs().maxCoeff() - 1.0);
    return beyond * std::abs(turn.degrees) * (3.14159265358979323846 / 180);
}

bool LineParser::check_extent(const std::vector<Motion>& motions)
{
    double degrees = 0, diagonals = 0;
    for (const Motion& motion : motions) {
        const bool is_turn = motion.kind == Motion::Kind::turn;
        degrees += is_turn ? std::abs(motion.degrees) : 0;
        diagonals += is_turn ? reach_of(motion) : motion.by.stableNorm();
    }
    if (!(degrees <= degrees_limit))
        return fail(2810, fmt::format("turns by {} degrees, the limit is {}", degrees, degrees_limit),
                    "ten turns at most; angles are in degrees");
    if (!(diagonals <= diagonals_limit))
        return fail(2810, fmt::format("moves by {:.6g} diagonals, the limit is {}", diagonals, diagonals_limit),
                    "lengths are fractions of the bounding box's diagonal");
    if (motions.size() > motions_limit)
        return fail(2810, fmt::format("has {} motions, the limit is {}", motions.size(), motions_limit),
                    "put several turns about one axis into one");
    return true;
}

bool LineParser::read_motions(std::vector<Motion>& motions)
{
    if (word_.empty()) return fail(2803, "no motion follows the region", motions_hint);
    bool is_held = false;
    while (!word_.empty()) {
        const std::string_view name = word_;
        advance();
        Motion motion;
        if (name == "hold") {
            is_held = true;
            continue;
        }
        if (!is_motion(name)) return fail(2803, fmt::format("motion {} not understood", excerpt(name)), motions_hint);
        if (!(name == "move" ? read_move(motion) : read_turn(motion))) return false;
        motions.push_back(motion);
    }
    if (is_held && !motions.empty()) return fail(2811, "the region is held and moved", "leave out hold or the motion");
    return check_extent(motions);
}

} // namespace

Script read_script(const std::string& path, DiagnosticList& diagnostics)
{
    Script script;
    script.path = path;
    std::optional<std::string> bytes = read_bytes(path, diagnostics);
    if (!bytes) return script;
    if (bytes->compare(0, 3, "\xef\xbb\xbf") == 0) bytes->erase(0, 3);
    const std::size_t errors_before = diagnostics.error_count();
    LineReader lines(*bytes);
    while (lines.next()) {
        ScriptLine line;
        line.number = lines.number();
        LineParser parser(lines.line(), script.where(line), diagnostics);
        if (parser.is_empty()) continue;
        if (parser.read_region(line.region) && parser.read_motions(line.motions)) script.lines.push_back(std::move(line));
    }
    if (script.lines.empty() && diagnostics.error_count() == errors_before)
        diagnostics.add(error_at(2801, path, "has no line with a region", shapes_hint));
    return script;
}

} // namespace pliant
