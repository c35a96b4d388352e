// Gmsh's format: 2.2 and 4.1, ASCII and binary.
#include "input/io/tet_builder.h"

#include "input/io/msh_elements.h"
#include "input/io/number_reader.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>
#include <vector>

namespace pliant {
namespace {

// Sizes of the numbers in binary files.
constexpr std::size_t int_size = 4, real_size = 8, long_size = 8;

// From the tags of nodes, which are any numbers, to their places in the file.
class NodeTags {
public:
    void add(std::int64_t tag)
    {
        is_running_ = is_running_ && (tags_.empty() || offset(tag) == tags_.size());
        tags_.emplace_back(tag, static_cast<std::uint32_t>(tags_.size()));
    }
    std::size_t count() const { return tags_.size(); }

    // Two nodes that have the same tag, if there are any.
    std::optional<std::pair<std::uint32_t, std::uint32_t>> sort()
    {
        if (is_running_) return std::nullopt;
        std::sort(tags_.begin(), tags_.end());
        const auto same = std::adjacent_find(tags_.begin(), tags_.end(),
                                             [](const auto& a, const auto& b) { return a.first == b.first; });
        if (same == tags_.end()) return std::nullopt;
        return std::make_pair(same[0].second, same[1].second);
    }
    std::optional<std::uint32_t> find(std::int64_t tag) const
    {
        if (tags_.empty()) return std::nullopt;
        if (is_running_) return offset(tag) < tags_.size() ? std::optional(std::uint32_t(offset(tag))) : std::nullopt;
        const auto at = std::lower_bound(tags_.begin(), tags_.end(), std::make_pair(tag, std::uint32_t(0)));
        if (at == tags_.end() || at->first != tag) return std::nullopt;
        return at->second;
    }

private:
    // From the first tag; without sign, so that no difference overflows.
    std::uint64_t offset(std::int64_t tag) const
    {
        return static_cast<std::uint64_t>(tag) - static_cast<std::uint64_t>(tags_[0].first);
    }

    std::vector<std::pair<std::int64_t, std::uint32_t>> tags_;
    bool is_running_ = true; // each is one more than the one before
};

class MshReader {
public:
    MshReader(const SourceFile& file, MeshFile& mesh)
        : file_(file)
        , mesh_(mesh)
        , numbers_(file)
        , tets_(file, mesh)
    {
    }

    bool read();

private:
    bool read_format();
    bool read_section(std::string_view name);
    bool begin_section(const char* name, bool& is_there);
    bool end_section(std::string_view name);
    bool fail_section(const std::string& what);

    bool read_nodes_2();
    bool read_nodes_4();
    bool read_node_block(std::uint64_t total);
    bool read_elements_2();
    bool read_block_2(std::uint64_t& element, std::uint64_t total);
    bool read_elements_4();
    bool read_element_block(std::uint64_t& element, std::uint64_t total);
    bool read_element(const MshElement& kind, std::uint64_t element);
    const MshElement* kind_of(std::int64_t type, std::uint64_t element);
    bool check_nodes();
    bool check_total(std::uint64_t total, const char* element, std::uint64_t minimal_text, std::uint64_t minimal_bytes);
    bool read_position(std::uint64_t node);

    const SourceFile& file_;
    MeshFile& mesh_;
    NumberReader numbers_;
    TetBuilder tets_;
    NodeTags tags_;
    bool is_version_4_ = false, is_binary_ = false;
    bool has_nodes_ = false, has_elements_ = false;
};

bool MshReader::read()
{
    if (!read_format()) return false;
    for (std::string_view word = numbers_.word(); !word.empty(); word = numbers_.word()) {
        if (word[0] != '$') {
            file_.error(2112, numbers_.where(), fmt::format("a section expected, found {}", excerpt(word)),
                        "the file is damaged or the counts of the section before are wrong: export it again");
            return false;
        }
        if (!read_section(word.substr(1))) return false;
    }
    if (!has_nodes_ || !has_elements_)
        return fail_section(fmt::format("section ${} is missing", has_nodes_ ? "Elements" : "Nodes"));
    return tets_.finish();
}

bool MshReader::fail_section(const std::string& what)
{
    file_.error(2117, file_.path, what, "the file is cut off or damaged: export it again");
    return false;
}

bool MshReader::read_format()
{
    numbers_.set_layout(NumberLayout::free);
    if (numbers_.word() != "$MeshFormat") return fail_section("section $MeshFormat does not come first");
    const std::string_view version = numbers_.word(), type = numbers_.word(), size = numbers_.word();
    const std::size_t line = numbers_.line();
    is_version_4_ = version == "4.1";
    is_binary_ = type == "1";
    const bool is_known
        = (is_version_4_ || version == "2.2" || version == "2") && (is_binary_ || type == "0") && size == "8";
    if (!is_known) {
        file_.error(2111, file_.at_line(line),
                    fmt::format("this kind of Gmsh file is not read: version {}, type {}, size {}", excerpt(version),
                                excerpt(type), excerpt(size)),
                    "export as version 4.1 or 2.2, ASCII or binary (Mesh.MshFileVersion)");
        return false;
    }
    if (is_binary_) {
        numbers_.rest_of_line();
        numbers_.set_layout(NumberLayout::little_endian);
        numbers_.begin("the header", 0, 0);
        const std::optional<std::int64_t> one = numbers_.integer(int_size);
        if (!one) return false;
        if (*one == 0x01000000)
            numbers_.set_layout(NumberLayout::big_endian);
        else if (*one != 1) {
            file_.error(2102, file_.path, "header not understood: the number that shows the byte order is not 1",
                        "the file is damaged: export it again");
            return false;
        }
    } else {
        numbers_.set_layout(NumberLayout::lines);
    }
    return end_section("MeshFormat");
}

bool MshReader::end_section(std::string_view name)
{
    const std::string_view word = numbers_.word();
    if (word.substr(0, 4) == "$End" && word.substr(4) == name) return true;
    if (word.empty()) {
        report_truncated(file_, fmt::format("section ${}", name));
    } else {
        file_.error(2110, numbers_.where(), fmt::format("more follows in ${}: {}", name, excerpt(word)),
                    "the counts of the section are wrong: export the file again");
    }
    return false;
}

bool MshReader::begin_section(const char* name, bool& is_there)
{
    if (is_there) return fail_section(fmt::format("section ${} comes twice", name));
    is_there = true;
    // Bytes begin behind the end of the line.
    if (is_binary_ && !is_version_4_) return true; // the count is text
    if (is_binary_) numbers_.rest_of_line();
    return true;
}

bool MshReader::read_section(std::string_view name)
{
    if (name == "Nodes") {
        return begin_section("Nodes", has_nodes_) && (is_version_4_ ? read_nodes_4() : read_nodes_2()) && end_section(name)
            && check_nodes();
    }
    if (name == "Elements") {
        if (!has_nodes_) return fail_section("section $Elements comes before $Nodes");
        return begin_section("Elements", has_elements_) && (is_version_4_ ? read_elements_4() : read_elements_2())
            && end_section(name);
    }
    // Names, geometry, data: nothing of ours. A long name could be almost found at every byte.
    constexpr std::size_t name_size_limit = 256;
    if (name.size() > name_size_limit) {
        file_.error(2112, file_.at_line(numbers_.line()), fmt::format("unknown section ${}", excerpt(name)),
                    "the file is damaged: export it again");
        return false;
    }
    const std::string end = fmt::format("$End{}", name);
    if (numbers_.skip_behind(end)) return true;
    report_truncated(file_, fmt::format("section ${}", excerpt(name)));
    return false;
}

bool MshReader::check_nodes()
{
    const auto same = tags_.sort();
    if (!same) return true;
    file_.error(2118, file_.path, fmt::format("nodes {} and {} have the same tag", same->first, same->second),
                "the file is damaged: export it again");
    return false;
}

// A declared number against the limits and against the bytes that are left.
bool MshReader::check_total(std::uint64_t total, const char* element, std::uint64_t minimal_text,
                            std::uint64_t minimal_bytes)
{
    const std::uint64_t limit = std::string_view(element) == "nodes" ? vertex_count_limit : face_count_limit;
    return check_count(file_, numbers_.line(), element, total, limit, numbers_.bytes_left(),
                       is_binary_ ? minimal_bytes : minimal_text);
}

bool MshReader::read_position(std::uint64_t node)
{
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        if (!numbers_.coordinate(real_size, node, mesh_.positions(static_cast<Eigen::Index>(node), axis))) return false;
    }
    return true;
}

// ------------------------------------------------------------------------------------------------------------ version 2.2

// Counts of 2.2 are text in binary files too.
std::optional<std::uint64_t> text_count(NumberReader& numbers, bool is_binary, NumberLayout bytes, const char* of_what)
{
    numbers.set_layout(NumberLayout::free);
    const std::optional<std::uint64_t> count = numbers.count(0, of_what);
    if (is_binary && count) numbers.rest_of_line();
    numbers.set_layout(is_binary ? bytes : NumberLayout::lines);
    return count;
}

bool MshReader::read_nodes_2()
{
    const NumberLayout layout = numbers_.layout();
    const std::optional<std::uint64_t> total = text_count(numbers_, is_binary_, layout, "nodes");
    if (!total || !check_total(*total, "nodes", 8, int_size + 3 * real_size)) return false;
    mesh_.positions.resize(static_cast<Eigen::Index>(*total), 3);
    for (std::uint64_t node = 0; node < *total; ++node) {
        if (!numbers_.begin("node", node, *total)) return false;
        const std::optional<std::int64_t> tag = numbers_.integer(int_size);
        if (!tag || !read_position(node) || !numbers_.end()) return false;
        tags_.add(*tag);
    }
    return true;
}

bool MshReader::read_elements_2()
{
    const NumberLayout layout = numbers_.layout();
    const std::optional<std::uint64_t> total = text_count(numbers_, is_binary_, layout, "elements");
    if (!total || !check_total(*total, "elements", 8, 2 * int_size)) return false;
    for (std::uint64_t element = 0; element < *total;) {
        if (!read_block_2(element, *total)) return false;
    }
    return true;
}

// One element of a text, or several of one type in bytes.
bool MshReader::read_block_2(std::uint64_t& element, std::uint64_t total)
{
    if (!numbers_.begin("element", element, total)) return false;
    if (!is_binary_ && !numbers_.integer(int_size)) return false; // its number
    const std::optional<std::int64_t> type = numbers_.integer(int_size);
    const std::optional<std::int64_t> size = !is_binary_ ? 1 : numbers_.integer(int_size);
    if (!type || !size) return false;
    const std::optional<std::uint64_t> tag_count = numbers_.count(int_size, "tags");
    const MshElement* kind = tag_count ? kind_of(*type, element) : nullptr;
    if (!kind) return false;
    if (*size < 1 || static_cast<std::uint64_t>(*size) > total - element) {
        file_.error(2102, numbers_.where(), fmt::format("element {}: a block of {} of {} elements", element, *size, total),
                    "the file is damaged: export it again");
        return false;
    }
    for (std::int64_t i = 0; i < *size; ++i, ++element) {
        if (is_binary_ && (!numbers_.begin("element", element, total) || !numbers_.skip(int_size))) return false;
        for (std::uint64_t tag = 0; tag < *tag_count; ++tag) {
            if (!numbers_.skip(int_size)) return false;
        }
        if (!read_element(*kind, element)) return false;
    }
    return true;
}

// ------------------------------------------------------------------------------------------------------------ version 4.1

bool MshReader::read_nodes_4()
{
    if (!numbers_.begin("the header of $Nodes", 0, 0)) return false;
    const std::optional<std::uint64_t> blocks = numbers_.count(long_size, "blocks of nodes");
    const std::optional<std::uint64_t> total = blocks ? numbers_.count(long_size, "nodes") : std::nullopt;
    if (!total || !numbers_.skip(long_size) || !numbers_.skip(long_size) || !numbers_.end()) return false;
    // The shortest: "1\n" and "0 0 0\n".
    if (!check_total(*total, "nodes", 8, long_size + 3 * real_size)) return false;
    mesh_.positions.resize(static_cast<Eigen::Index>(*total), 3);
    for (std::uint64_t block = 0; block < *blocks; ++block) { // each takes bytes of the file, so a false number ends
        if (!numbers_.begin("block of nodes", block, *blocks) || !read_node_block(*total)) return false;
    }
    if (tags_.count() == *total) return true;
    file_.error(2102, numbers_.where(), fmt::format("$Nodes declares {} nodes, its blocks hold {}", *total, tags_.count()),
                "the file is damaged: export it again");
    return false;
}

bool MshReader::read_node_block(std::uint64_t total)
{
    const std::optional<std::int64_t> dimension = numbers_.integer(int_size);
    if (!dimension || !numbers_.integer(int_size)) return false; // the tag of the entity
    const std::optional<std::int64_t> has_parameters = numbers_.integer(int_size);
    const std::optional<std::uint64_t> size = has_parameters ? numbers_.count(long_size, "nodes of a block") : std::nullopt;
    if (!size || !numbers_.end()) return false;
    const std::uint64_t begin = tags_.count();
    if (*dimension < 0 || *dimension > 3 || *size > total - begin) {
        file_.error(
            2102, numbers_.where(),
            fmt::format("a block of {} nodes of dimension {}, {} of {} nodes left", *size, *dimension, total - begin, total),
            "the file is damaged: export it again");
        return false;
    }
    for (std::uint64_t i = 0; i < *size; ++i) {
        if (!numbers_.begin("node", begin + i, total)) return false;
        const std::optional<std::int64_t> tag = numbers_.integer(long_size);
        if (!tag || !numbers_.end()) return false;
        tags_.add(*tag);
    }
    for (std::uint64_t i = 0; i < *size; ++i) {
        if (!numbers_.begin("node", begin + i, total) || !read_position(begin + i)) return false;
        for (std::int64_t p = 0; p < (*has_parameters != 0 ? *dimension : 0); ++p) {
            if (!numbers_.skip(real_size)) return false;
        }
        if (!numbers_.end()) return false;
    }
    return true;
}

bool MshReader::read_elements_4()
{
    if (!numbers_.begin("the header of $Elements", 0, 0)) return false;
    const std::optional<std::uint64_t> blocks = numbers_.count(long_size, "blocks of elements");
    const std::optional<std::uint64_t> total = blocks ? numbers_.count(long_size, "elements") : std::nullopt;
    if (!total || !numbers_.skip(long_size) || !numbers_.skip(long_size) || !numbers_.end()) return false;
    if (!check_total(*total, "elements", 4, 2 * long_size)) return false;
    std::uint64_t element = 0;
    for (std::uint64_t block = 0; block < *blocks; ++block) {
        if (!numbers_.begin("block of elements", block, *blocks) || !read_element_block(element, *total)) return false;
    }
    if (element == *total) return true;
    file_.error(2102, numbers_.where(), fmt::format("$Elements declares {} elements, its blocks hold {}", *total, element),
                "the file is damaged: export it again");
    return false;
}

bool MshReader::read_element_block(std::uint64_t& element, std::uint64_t total)
{
    // The dimension and the tag of the entity; the type says the dimension again.
    if (!numbers_.integer(int_size) || !numbers_.integer(int_size)) return false;
    const std::optional<std::int64_t> type = numbers_.integer(int_size);
    const std::optional<std::uint64_t> size = type ? numbers_.count(long_size, "elements of a block") : std::nullopt;
    if (!size || !numbers_.end()) return false;
    if (*size > total - element) {
        file_.error(2102, numbers_.where(),
                    fmt::format("a block of {} elements, {} of {} left", *size, total - element, total),
                    "the file is damaged: export it again");
        return false;
    }
    if (*size == 0) return true;
    const MshElement* kind = kind_of(*type, element);
    if (!kind) return false;
    for (std::uint64_t i = 0; i < *size; ++i, ++element) {
        if (!numbers_.begin("element", element, total) || !numbers_.skip(long_size) || !read_element(*kind, element))
            return false;
    }
    return true;
}

// --------------------------------------------------------------------------------------------------------------- elements

// What a type means, if it is read or left out; else P2114.
const MshElement* MshReader::kind_of(std::int64_t type, std::uint64_t element)
{
    const MshElement* kind = find_msh_element(type);
    if (kind && (kind->dimension < 3 || kind->is_tet)) return kind;
    tets_.refuse(numbers_.where(), element, kind ? kind->name : fmt::format("of the unknown type {}", type));
    return nullptr;
}

// Its nodes and its end.
bool MshReader::read_element(const MshElement& kind, std::uint64_t element)
{
    const std::size_t size = is_version_4_ ? long_size : int_size;
    if (!kind.is_tet) {
        for (int i = 0; i < kind.node_count; ++i) {
            if (!numbers_.skip(size)) return false;
        }
        tets_.skip(kind.name);
        return numbers_.end();
    }
    std::array<std::int64_t, 4> corners {};
    for (std::int64_t& corner : corners) {
        const std::optional<std::int64_t> tag = numbers_.integer(size);
        if (!tag) return false;
        const std::optional<std::uint32_t> node = tags_.find(*tag);
        if (!node)
            file_.error(2103, numbers_.where(),
                        fmt::format("element {} uses node {}, which the file does not have", element, *tag),
                        "nodes are missing or the element is wrong: export the file again");
        corner = node ? *node : 0;
    }
    tets_.add(numbers_.line(), corners);
    return numbers_.end();
}

} // namespace

bool read_msh(const SourceFile& file, MeshFile& mesh) { return MshReader(file, mesh).read(); }

} // namespace pliant
